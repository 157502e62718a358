"""What a caller wants to see: a region of the picture at a scale, and how fine the model has to be known for it."""

from __future__ import annotations

import math
from typing import NamedTuple

from sgicodec.bitstream.header import Header
from sgicodec.errors import LimitError, UsageError
from sgicodec.model.layout import ROOT_LOG

__all__ = ["BASE_ALONE", "MAX_OUTPUT_SAMPLES", "Region", "View", "finest_cells", "view_of"]

Region = tuple[int, int, int, int]
"""x, y, width, height in pixels."""

MAX_OUTPUT_SAMPLES = 1 << 31
"""Most samples (pixels times channels) that one call renders."""

BASE_ALONE = ROOT_LOG + 1
"""log2 of cells larger than any: none is drawn, the base layer alone is."""

_BASE_CELL = 1.5
"""Output pixels per cell of the base layer from which down it alone is drawn of pictures in several tiles: quick, and a
little soft. Nothing pays between it and the whole model: large pixels get their mean from small Gaussians, and part of
these is worse than none (docs/large.md).
"""


class View(NamedTuple):
    """Where it starts in the picture, output pixels for each of the picture's, and its size in output pixels."""

    x: int
    y: int
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


def finest_cells(header: Header, view: View) -> int:
    """log2 of the smallest cells that a view shows: 0 for all, BASE_ALONE for none."""
    cell = header.spec.base_cell * max(view.sx, view.sy)
    return BASE_ALONE if header.grid.count > 1 and 0 < cell <= _BASE_CELL else 0


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
