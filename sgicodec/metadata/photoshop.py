"""Photoshop's image resources, in PSD files, JPEG and TIFF, and what else a PSD file holds (Adobe Photoshop File
Formats, 2019).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import NamedTuple

from sgicodec.metadata import density
from sgicodec.metadata.filebytes import Bytes

IPTC = "IPTC"
_HEADER = struct.Struct(">4sH6xH8xHH")
_RESOLUTION, _IPTC_BLOCK, _COPYRIGHT, _URL, _EXIF, _XMP = 1005, 1028, 1034, 1035, 1058, 1060
_PATHS = range(2000, 2998)
_CMYK, _MULTICHANNEL = 4, 7
_COLOURS = {0: 1, 1: 1, 2: 1, 3: 3, _CMYK: 4}
"""Channels of each mode."""
_DEEP_LAYERS = (b"8BIMLr16", b"8BIMLr32")


class _Contents(NamedTuple):
    """mode, channels: as the header has them; resources: by their numbers; layers: how many, less than 0 where the
    first further channel is the alpha of them all.
    """

    mode: int
    channels: int
    resources: dict[int, bytes]
    layers: int


def is_psd(data: Bytes) -> bool:
    """Whether it is a PSD file, by its beginning."""
    return len(data) >= _HEADER.size and bytes(data[:4]) == b"8BPS"


def is_multichannel(data: Bytes) -> bool:
    """Whether the channels of a PSD file are inks of any number and colour."""
    return bool(_HEADER.unpack(data[: _HEADER.size])[-1] == _MULTICHANNEL)


def find(data: Bytes) -> tuple[bytes | None, bytes | None, bytes | None]:
    """EXIF, XMP and `geo` of a PSD file."""
    found = _contents(data).resources
    exif = found.get(_EXIF) or None
    stated = found.get(_RESOLUTION, b"")
    pair = struct.unpack(">I4xI", stated[:12]) if len(stated) >= 12 else (0, 0)
    return exif, found.get(_XMP), density.tags(density.per_inch([value / 65536 for value in pair]), exif)


def left_behind(data: Bytes) -> list[str]:
    """Names of what is not kept of a PSD file."""
    found = _contents(data)
    more = found.channels - _COLOURS.get(found.mode, found.channels) - (found.layers < 0)
    lost = ["inks (RGB instead)"] if found.mode == _CMYK else []
    lost += [f"{more} more channels" if more > 1 else "another channel"] if more > 0 else []
    lost += ["layers"] if found.layers else []
    return lost + names(found.resources)


def names(resources: Bytes | dict[int, bytes]) -> list[str]:
    """Names of what is not kept of resources, or of a block of them."""
    found = resources if isinstance(resources, dict) else dict(_resources(resources))
    lost = [IPTC] if _IPTC_BLOCK in found else []
    lost += ["clipping paths"] if any(number in _PATHS for number in found) else []
    return lost + (["Photoshop's copyright"] if any(found.get(_COPYRIGHT, b"")) or found.get(_URL) else [])


def _contents(data: Bytes) -> _Contents:
    _, version, channels, _, mode = _HEADER.unpack(data[: _HEADER.size])
    at = _HEADER.size
    at += 4 + int.from_bytes(data[at : at + 4], "big")
    length = int.from_bytes(data[at : at + 4], "big")
    resources = dict(_resources(data[at + 4 : at + 4 + length]))
    at += 4 + length
    wide = 4 * version
    start = at + wide
    deep = any(kind in bytes(data[start : start + 256]) for kind in _DEEP_LAYERS)
    has_layers = int.from_bytes(data[at:start], "big") and int.from_bytes(data[start : start + wide], "big")
    count = int.from_bytes(data[start + wide : start + wide + 2], "big", signed=True) if has_layers else int(deep)
    return _Contents(mode, channels, resources, count)


def _resources(block: Bytes) -> Iterator[tuple[int, bytes]]:
    """Number and contents of each whole one."""
    at = 0
    while at + 12 <= len(block) and bytes(block[at : at + 4]) == b"8BIM":
        number, name = struct.unpack(">HB", block[at + 4 : at + 7])
        start = at + 6 + (name + 2) // 2 * 2 + 4
        length = int.from_bytes(block[start - 4 : start], "big")
        if start + length > len(block):
            return
        yield number, bytes(block[start : start + length])
        at = start + length + length % 2
