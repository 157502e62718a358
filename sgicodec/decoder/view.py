"""A view: a region of the picture at a scale, and the part of the overview that shows the same."""

from __future__ import annotations

import math
from typing import NamedTuple

from sgicodec.bitstream.header import Header
from sgicodec.errors import LimitError, UsageError

__all__ = ["MAX_OUTPUT_SAMPLES", "OVERVIEW", "Region", "View", "overview_size", "overview_view", "view_of"]

Region = tuple[int, int, int, int]
"""x, y, width, height in pixels."""

MAX_OUTPUT_SAMPLES = 1 << 31
"""Most samples (pixels times channels) that one call renders."""

OVERVIEW = 16
"""Pixels of the picture's side for each of its overview's."""

_ROUNDING = 1e-9


class View(NamedTuple):
    """Where it starts in the picture, output pixels for each of the picture's, and its size in output pixels."""

    x: float
    y: float
    sx: float
    sy: float
    columns: int
    rows: int


def view_of(
    header: Header,
    region: Region | None,
    scale: float | None,
    size: tuple[int, int] | None,
    most: int | None = MAX_OUTPUT_SAMPLES,
) -> View:
    """The view that `Stream.render` is asked for, of at most `most` samples. Raises UsageError or LimitError."""
    x, y, width, height = region or (0, 0, header.width, header.height)
    if width < 1 or height < 1 or x < 0 or y < 0 or x + width > header.width or y + height > header.height:
        raise UsageError(
            f"region {x},{y},{width},{height} is not inside the picture of {header.width}×{header.height} pixels"
        )
    columns, rows = _output_size(width, height, scale, size)
    if most is not None and columns * rows * header.spec.channels > most:
        raise LimitError(f"{columns}×{rows} pixels are too many for one call; decode regions or a smaller scale")
    return View(x, y, columns / width, rows / height, columns, rows)


def overview_size(width: int, height: int) -> tuple[int, int]:
    """Columns and rows of a picture's overview."""
    return max(1, round(width / OVERVIEW)), max(1, round(height / OVERVIEW))


def overview_view(header: Header, view: View) -> View | None:
    """What of the picture's overview a view shows; None for one that shows more than the overview holds, and of an
    overview that is no smaller than the picture.
    """
    columns, rows = overview_size(header.width, header.height)
    if (columns, rows) == (header.width, header.height):
        return None
    across, down = columns / header.width, rows / header.height
    sx, sy = _near_one(view.sx / across), _near_one(view.sy / down)
    if _enlarges(view.columns, sx) or _enlarges(view.rows, sy):
        return None
    return View(view.x * across, view.y * down, sx, sy, view.columns, view.rows)


def _near_one(scale: float) -> float:
    return 1.0 if abs(scale - 1) < _ROUNDING else scale


def _enlarges(count: int, scale: float) -> bool:
    """Whether `count` output pixels are more than the pixels that they show, rounded up."""
    return count > math.ceil(count / scale - _ROUNDING)


def _output_size(width: int, height: int, scale: float | None, size: tuple[int, int] | None) -> tuple[int, int]:
    if size is not None:
        if scale is not None:
            raise UsageError("give a scale or a size, not both")
        if min(size) < 1:
            raise UsageError(f"a size of {size[0]}×{size[1]} pixels holds no picture")
        return size
    if scale is None:
        return width, height
    if not (scale > 0 and math.isfinite(scale * max(width, height))):
        raise UsageError(f"a scale of {scale:g}; it must be a positive number")
    return max(1, round(width * scale)), max(1, round(height * scale))
