"""The eight orientations of TIFF and EXIF (tag 274)."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["is_sideways", "upright"]


def is_sideways(orientation: int) -> bool:
    """Whether width and height change places when the picture is turned upright."""
    return 5 <= orientation <= 8


def upright(pixels: npt.NDArray[Any], orientation: int) -> npt.NDArray[Any]:
    """Turn stored pixels [H, W, C] the way they are meant to be seen; a value outside 1..8 means 1.

    The names in TIFF 6.0 say where the stored row 0 and column 0 belong: 6, for one, is "row 0 at the right,
    column 0 at the top".
    """
    if is_sideways(orientation):
        pixels = pixels.swapaxes(0, 1)
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    return np.ascontiguousarray(pixels)
