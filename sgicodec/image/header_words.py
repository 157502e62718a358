"""What a header says that a stream does not keep, of files whose metadata OpenImageIO alone reads: EXR, DPX, FITS."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sgicodec.metadata.stated_colours import PRIMARIES, WHITE

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

_KEPT_ELSEWHERE = {"jpeg", "jpegxl", "png", "psd", "tiff", "webp"}
"""Formats whose bytes tell (`metadata.left_behind`)."""
_IDLE = {
    "compression",
    "planarconfig",
    "Bscale",
    "Bzero",
    "DateTime",
    "Orientation",
    "Software",
    "screenWindowCenter",
    "screenWindowWidth",
}
"""Attributes that say nothing of the picture itself or are applied, as are those of a format's own that OpenImageIO
names.
"""
_USUAL = {"PixelAspectRatio": (1.0,), "chromaticities": (*PRIMARIES, *WHITE)}
_USUAL_GAMMA = "g22_rec709_scene"
"""What OpenImageIO calls colours of a Targa whose gamma is 2.2, nearly that of sRGB."""
_NO_TRANSFER = ("Undefined", "User defined", "Unspecified video")
_PLAIN_NAMES = {"r", "g", "b", "a", "y", "red", "green", "blue", "alpha", "i", "channel"}
_MAX_NAMES = 6


def not_kept(spec: ImageSpec, kind: str) -> list[str]:
    """Names of it. kind: OpenImageIO's name of the format."""
    if kind in _KEPT_ELSEWHERE:
        return []
    own = ("oiio:", "openexr:", "ICCProfile:") if kind == "openexr" else ("",)
    names = [one.name for one in spec.extra_attribs if _says_something(one.name, one.value, own)]
    found = names[:_MAX_NAMES]
    if len(names) > _MAX_NAMES:
        found.append(f"{len(names) - _MAX_NAMES} more attributes")
    if any(name.lower().rstrip("0123456789") not in _PLAIN_NAMES for name in spec.channelnames):
        found.append("names of channels")
    if (transfer := spec.get("dpx:Transfer", "Undefined")) not in _NO_TRANSFER:
        found.append(f"colour space ({transfer})")
    space = spec.get("oiio:ColorSpace", _USUAL_GAMMA)
    if kind in ("targa", "cineon") and space != _USUAL_GAMMA:
        found.append(f"colour space ({space.partition('_')[0]})")
    whole = (spec.full_x, spec.full_y, spec.full_width, spec.full_height)
    if (spec.x, spec.y, spec.width, spec.height) != whole:
        place = f"at {spec.x - spec.full_x}, {spec.y - spec.full_y}"
        found.append(f"its place {place} in a window of {spec.full_width}×{spec.full_height} pixels")
    return found


def _says_something(name: str, value: Any, own: tuple[str, ...]) -> bool:
    """own: how names with a colon begin that OpenImageIO made."""
    if name in _IDLE or (":" in name and name.startswith(own) and not name.startswith("smpte:")):
        return False
    try:
        stated = np.asarray(value, np.float64).ravel()
    except (TypeError, ValueError):
        return True
    usual = _USUAL.get(name, ())
    return stated.size != len(usual) or not np.allclose(stated, usual, atol=1e-3)
