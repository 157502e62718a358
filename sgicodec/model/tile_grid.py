"""The tile grid: how a picture is cut into tiles. Native code knows which of them draw an output pixel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sgicodec.errors import UsageError

Rect = tuple[int, int, int, int]
"""x, y, width, height in pixels."""


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
