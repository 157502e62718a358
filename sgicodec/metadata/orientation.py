"""The eight orientations of TIFF and EXIF (tag 274).

The names in TIFF 6.0 say where the stored row 0 and column 0 belong: 6, for one, is "row 0 at the right, column 0 at
the top". A value outside 1..8 means 1.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Window = tuple[int, int, int, int]
"""x, y, width, height in pixels."""


def is_sideways(orientation: int) -> bool:
    """Whether width and height change places when the picture is turned upright."""
    return 5 <= orientation <= 8


def is_flipped(orientation: int) -> bool:
    """Whether rows, after any exchange with columns, run from the bottom up."""
    return orientation in (3, 4, 7, 8)


def is_mirrored(orientation: int) -> bool:
    """Whether columns, after any exchange with rows, run from right to left."""
    return orientation in (2, 3, 6, 7)


def upright(pixels: npt.NDArray[Any], orientation: int) -> npt.NDArray[Any]:
    """Turn stored pixels [H, W, C] the way they are meant to be seen."""
    if is_sideways(orientation):
        pixels = pixels.swapaxes(0, 1)
    if is_flipped(orientation):
        pixels = pixels[::-1]
    if is_mirrored(orientation):
        pixels = pixels[:, ::-1]
    return np.ascontiguousarray(pixels)


def stored_window(window: Window, width: int, height: int, orientation: int) -> Window:
    """Where the pixels of a window of the upright picture, of width × height pixels, stand in the stored one."""
    x, y, w, h = window
    if is_mirrored(orientation):
        x = width - x - w
    if is_flipped(orientation):
        y = height - y - h
    return (y, x, h, w) if is_sideways(orientation) else (x, y, w, h)
