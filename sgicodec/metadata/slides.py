"""Descriptions of slides: the size of a pixel and the magnification of the objective, as Aperio and OME state them."""

from __future__ import annotations

import math
import re

_MPP = re.compile(rb"\bMPP\s*=\s*([0-9.]+)")
_POWER = re.compile(rb"""(?:\bAppMag\s*=\s*|\bNominalMagnification=")([0-9]{1,4}(?:\.[0-9]{1,4})?)""")

_SQUARE = 0.01
"""Part by which the scales across and down may differ for pixels to be as square as before."""


def microns_per_pixel(description: bytes) -> float | None:
    """Aperio's MPP, micrometres; None where it is not stated or no number."""
    found = _MPP.search(description)
    try:
        return float(found[1]) if found else None
    except ValueError:
        return None


def magnification(description: bytes) -> str | None:
    """That of the objective, in digits; None where it is not stated."""
    found = _POWER.search(description)
    return found[1].decode("ascii") if found else None


def scaled(description: bytes, across: float, down: float) -> bytes:
    """The description of a picture at this scale: MPP changes along, and is left without a number where pixels are not
    square any more.
    """
    old = microns_per_pixel(description)
    if old is None or across == down == 1:
        return description
    is_square = math.isclose(across, down, rel_tol=_SQUARE)
    new = f"{old / math.sqrt(across * down):.6g}".encode() if is_square else b""
    return _MPP.sub(lambda found: found[0][: found.start(1) - found.start()] + new, description)
