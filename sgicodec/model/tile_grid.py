"""The tile grid: how a picture is cut into tiles, and which tiles contribute to an output pixel."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from sgicodec.errors import UsageError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Axis", "Rect", "Segment", "TileGrid"]

Rect = tuple[int, int, int, int]
"""x, y, width, height in pixels."""


@dataclass(frozen=True)
class Segment:
    """A run of output pixels first … last − 1 along an axis that are drawn by tile `tile` alone, or by `tile` and the
    next one: then `weight` [last − first] is the next one's share, else None.
    """

    first: int
    last: int
    tile: int
    weight: NDArray[np.float32] | None = None


@dataclass(frozen=True)
class Axis:
    """`length` pixels cut into `count` cores of nearly equal size. A tile reaches `apron` pixels beyond its core on
    each side where there is another tile; over the 2 · apron pixels that two tiles share one fades into the other.
    """

    length: int
    count: int
    apron: int

    def edge(self, index: int) -> int:
        """Where core `index` begins."""
        return index * self.length // self.count

    def extent(self, index: int) -> tuple[int, int]:
        """First pixel of tile `index`, and the one behind its last."""
        first, last = self.edge(index), self.edge(index + 1)
        return first - self.apron * (index > 0), last + self.apron * (index + 1 < self.count)

    def segments(self, start: float, scale: float, first: int, count: int) -> Iterator[Segment]:
        """The runs of output pixels first … first + count − 1 of a picture drawn at `scale` from `start` on, in pixels.

        The share of a tile rises linearly with the distance of a pixel's centre from where the tile begins.
        """
        import numpy as np  # takes long to load, and headers do without

        at = start + (first + np.arange(count) + 0.5) / scale
        lowest, highest = self._around(float(at[0]), float(at[-1]))
        begin, index, end = 0, lowest, min(highest, self.count - 1)
        while index < end:
            edge = self.edge(index + 1)
            before, behind = np.searchsorted(at, [edge - self.apron, edge + self.apron]).tolist()
            if before > begin:
                yield Segment(begin, before, index)
            if behind > before:
                share = (at[before:behind] - (edge - self.apron)) / (2 * self.apron)
                yield Segment(before, behind, index, share.astype(np.float32))
            begin = max(begin, behind)
            if begin >= count:
                return
            index = max(index + 1, self._around(float(at[begin]), float(at[begin]))[0])  # tiles between centres
        yield Segment(begin, count, end)

    def _around(self, start: float, stop: float) -> tuple[int, int]:
        """A range of tile numbers that holds all which draw in start … stop."""
        size = self.length / self.count
        return max(0, int(start / size) - 1), min(self.count, int(stop / size) + 2)


@dataclass(frozen=True)
class TileGrid:
    """The tiles of a picture, numbered row by row. `tile` is the largest side of a core, 0 for a single tile."""

    width: int
    height: int
    tile: int
    apron: int

    def __post_init__(self) -> None:
        if self.tile and not 0 <= 4 * self.apron <= self.tile:
            raise UsageError(f"an apron of {self.apron} pixels; it must be at most a quarter of the tile's {self.tile}")

    @cached_property
    def across(self) -> Axis:
        """Tiles from left to right."""
        return self._axis(self.width)

    @cached_property
    def down(self) -> Axis:
        """Tiles from top to bottom."""
        return self._axis(self.height)

    def _axis(self, length: int) -> Axis:
        return Axis(length, -(-length // self.tile) if self.tile else 1, self.apron)

    @property
    def count(self) -> int:
        """Number of tiles."""
        return self.across.count * self.down.count

    def number(self, column: int, row: int) -> int:
        """Number of the tile in this place."""
        return row * self.across.count + column

    def rect(self, number: int) -> Rect:
        """What a tile covers, its apron included."""
        row, column = divmod(number, self.across.count)
        (left, right), (top, bottom) = self.across.extent(column), self.down.extent(row)
        return left, top, right - left, bottom - top

    def core(self, number: int) -> Rect:
        """The pixels that are a tile's own: cores cover the picture without overlap."""
        row, column = divmod(number, self.across.count)
        left, top = self.across.edge(column), self.down.edge(row)
        return left, top, self.across.edge(column + 1) - left, self.down.edge(row + 1) - top
