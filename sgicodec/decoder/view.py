"""A view: a region of the picture at a scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Integral, Real
from typing import Any, NamedTuple

from sgicodec import _native
from sgicodec._native import overview_size
from sgicodec.bitstream.header import MAX_SIDE, Header
from sgicodec.decoder.levels import Level
from sgicodec.errors import LimitError, RegionError, UsageError

__all__ = [
    "MAX_OUTPUT_SAMPLES",
    "Region",
    "Size",
    "View",
    "inner_view",
    "level_view",
    "overview_size",
    "region_of_level",
    "view_of",
]

Region = tuple[int, int, int, int]
"""x, y, width, height in pixels."""

Size = tuple[int | None, int | None]
"""Width and height in pixels; one that is None follows from the aspect."""

MAX_OUTPUT_SAMPLES = 1 << 31
"""Most samples (pixels times channels) that one call renders."""


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
    size: Size | None,
    most: int | None = MAX_OUTPUT_SAMPLES,
    boundless: bool = False,
) -> View:
    """The view that a stream is asked for, of at most `most` samples.

    Raises UsageError for arguments that make no sense or ask for too much, RegionError for a region that is not inside
    the picture unless it is boundless, and LimitError for a picture that is too large as it is.
    """
    whole = (0, 0, header.width, header.height)
    x, y, width, height = whole if region is None else _integers("region", region, 4)
    outside = x < 0 or y < 0 or x + width > header.width or y + height > header.height
    if width < 1 or height < 1 or (outside and not boundless):
        raise RegionError(
            f"region {x},{y},{width},{height} is not inside the picture of {header.width}×{header.height} pixels"
        )
    columns, rows = _output_size(width, height, scale, size)
    if max(columns, rows) > MAX_SIDE:
        raise UsageError(f"{columns}×{rows} pixels are too many; a side has at most {MAX_SIDE}")
    if most is not None and columns * rows * header.spec.channels > most:
        error = LimitError if (region, scale, size) == (None, None, None) else UsageError
        raise error(f"{columns}×{rows} pixels are too many for one call; decode regions or a smaller scale")
    return View(x, y, columns / width, rows / height, columns, rows)


def level_view(
    header: Header, levels: Sequence[Level], location: tuple[int, int], level: int, size: tuple[int, int]
) -> View:
    """The view of `size` pixels of a level, from `location` in the picture on. Raises UsageError."""
    (x, y), (columns, rows) = _integers("location", location, 2), _integers("size", size, 2)
    if isinstance(level, bool) or not isinstance(level, Integral) or not 0 <= level < len(levels):
        raise RegionError(f"level {level!r}; there are 0 to {len(levels) - 1}")
    if columns < 1 or rows < 1:
        raise RegionError(f"a size of {columns}×{rows} pixels holds no picture")
    if columns * rows * header.spec.channels > MAX_OUTPUT_SAMPLES:
        raise UsageError(f"{columns}×{rows} pixels are too many for one call")
    found = levels[int(level)]
    return View(x, y, found.width / header.width, found.height / header.height, columns, rows)


def region_of_level(header: Header, levels: Sequence[Level], level: int, region: Region | None) -> View:
    """The view of a region in a level's own pixels. Raises UsageError, RegionError."""
    whole = level_view(header, levels, (0, 0), level, levels[0][:2])  # checks the level
    found = levels[int(level)]
    x, y, columns, rows = _integers("region", (0, 0, *found[:2]) if region is None else region, 4)
    if min(x, y) < 0 or min(columns, rows) < 1 or x + columns > found.width or y + rows > found.height:
        raise RegionError(
            f"region {x},{y},{columns},{rows} is not inside a level of {found.width}×{found.height} pixels"
        )
    return View(x / whole.sx, y / whole.sy, whole.sx, whole.sy, columns, rows)


def inner_view(view: View, width: int, height: int) -> tuple[View, int, int]:
    """The part of a view whose pixels have their centres in the picture, and its first column and row."""
    inner, left, top = _native.inner_view(view, width, height)
    return View(*inner), left, top


def _output_size(width: int, height: int, scale: float | None, size: Size | None) -> tuple[int, int]:
    if size is not None:
        if scale is not None:
            raise UsageError("give a scale or a size, not both")
        return _whole_size(width, height, size)
    if scale is None:
        return width, height
    if isinstance(scale, bool) or not isinstance(scale, Real):
        raise UsageError(f"a scale of {scale!r}; it must be a positive number")
    if not (scale > 0 and math.isfinite(scale * max(width, height))):
        raise UsageError(f"a scale of {scale:g}; it must be a positive number")
    return max(1, round(width * scale)), max(1, round(height * scale))


def _whole_size(width: int, height: int, size: Size) -> tuple[int, int]:
    """The size in pixels, a side that is None by the aspect of `width` × `height`."""
    given = [side for side in size if side is not None] if isinstance(size, Sequence) and len(size) == 2 else []
    if not given:
        raise UsageError(f"size {size!r}; give (width, height), of which one may be None")
    if min(_integers("size", given, len(given))) < 1:
        raise UsageError(f"a size of {size[0]}×{size[1]} pixels holds no picture")
    wide, high = size
    if wide is None:
        wide = max(1, round(width * (high or 1) / height))
    if high is None:
        high = max(1, round(height * wide / width))
    return int(wide), int(high)


def _integers(what: str, values: Sequence[Any], count: int) -> tuple[int, ...]:
    """The values as integers. Raises UsageError for others, and for another number of them."""
    try:
        found = tuple(value.__index__() for value in values)
    except (TypeError, AttributeError):
        found = ()
    if len(found) != count:
        raise UsageError(f"{what} {values!r}; it must be {count} integers")
    return found
