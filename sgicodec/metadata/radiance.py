"""The header of Radiance pictures (Radiance's File Formats, 1997): lines of text before the first empty one."""

from __future__ import annotations

from sgicodec.metadata.filebytes import Bytes
from sgicodec.metadata.stated_colours import PRIMARIES, WHITE

_MOST, _NEAR = 1 << 14, 1e-3
_XYZ = "32-bit_rle_xyze"
_IDLE = ("FORMAT", "SOFTWARE", "CAPDATE")
"""Names of lines that say nothing of the picture itself."""
_USUAL = {
    "EXPOSURE": ((1.0,),),
    "PIXASPECT": ((1.0,),),
    "GAMMA": ((1.0,),),
    "COLORCORR": ((1.0, 1.0, 1.0),),
    "PRIMARIES": ((*PRIMARIES, 0.3333, 0.3333), (*PRIMARIES, *WHITE)),
}
"""Numbers that say nothing new: sRGB's primaries beside Radiance's white, or its own."""


def is_radiance(data: Bytes) -> bool:
    """Whether it is such a picture, by its beginning."""
    return bytes(data[:2]) == b"#?"


def damage(data: Bytes) -> str | None:
    """Why OpenImageIO does not read it, where that says something else."""
    if _lines(data).get("FORMAT") != _XYZ:
        return None
    return "its colours are XYZ, which OpenImageIO does not read; convert it first, as with ra_xyze -r of Radiance"


def left_behind(data: Bytes) -> list[str]:
    """Names of what it says that is not kept."""
    found = [name for name, text in _lines(data).items() if name not in _IDLE and not _is_usual(name, text)]
    return ["colour space (PRIMARIES)" if name == "PRIMARIES" else name for name in found]


def _lines(data: Bytes) -> dict[str, str]:
    """Names and values of its header."""
    head = bytes(data[:_MOST]).split(b"\n\n")[0].decode("latin-1")
    pairs = (line.split("=", 1) for line in head.splitlines() if "=" in line and not line.startswith("#"))
    return {name.strip(): text.strip() for name, text in pairs if name.strip().isupper()}


def _is_usual(name: str, text: str) -> bool:
    try:
        stated = [float(word) for word in text.split()]
    except ValueError:
        return False
    return any(
        len(stated) == len(each) and all(abs(a - b) < _NEAR for a, b in zip(stated, each, strict=True))
        for each in _USUAL.get(name, ())
    )
