"""How the pixels of a picture moved: turned upright, or cut and scaled to what a view shows."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sgicodec.metadata.orientation import is_flipped, is_mirrored, is_sideways


@dataclass(frozen=True)
class Motion:
    """A picture of width × height stored pixels was turned upright. Of what that gave, the region whose corner is
    (x, y) became columns × rows pixels, scale_x × scale_y for each.
    """

    width: int
    height: int
    orientation: int = 1
    x: float = 0.0
    y: float = 0.0
    scale_x: float = 1.0
    scale_y: float = 1.0
    columns: int = 0
    rows: int = 0

    @property
    def is_sideways(self) -> bool:
        """Whether what was across is down now."""
        return is_sideways(self.orientation)

    @property
    def is_turned(self) -> bool:
        """Whether pixels have other neighbours at their sides."""
        return self.orientation in range(2, 9)

    @property
    def is_whole(self) -> bool:
        """Whether it shows the picture from edge to edge."""
        ends = (self.x + self.columns / self.scale_x, self.y + self.rows / self.scale_y)
        near = (
            math.isclose(end, size, abs_tol=1e-6) for end, size in zip(ends, (self.width, self.height), strict=True)
        )
        return self.columns == 0 or ((self.x, self.y) == (0, 0) and all(near))

    @property
    def is_none(self) -> bool:
        """Whether pixels are where they were."""
        return not self.is_turned and self.is_whole and (self.scale_x, self.scale_y) == (1, 1)

    def point(self, x: float, y: float) -> tuple[int, int] | None:
        """Where the pixel (x, y) is now; None for outside."""
        width, height = self.width, self.height
        if self.is_sideways:
            x, y, width, height = y, x, height, width
        if is_mirrored(self.orientation):
            x = width - 1 - x
        if is_flipped(self.orientation):
            y = height - 1 - y
        x, y = (x + 0.5 - self.x) * self.scale_x, (y + 0.5 - self.y) * self.scale_y
        columns, rows = (self.columns, self.rows) if self.columns else (width, height)
        return (math.floor(x), math.floor(y)) if 0 <= x < columns and 0 <= y < rows else None

    def size(self, across: float, down: float) -> tuple[int, int]:
        """That of something in the picture."""
        if self.is_sideways:
            across, down = down, across
        return max(1, round(across * self.scale_x)), max(1, round(down * self.scale_y))

    def size_of_all(self, across: int, down: int) -> tuple[int, int]:
        """That of the picture, which was stated so."""
        if self.columns:
            return self.columns, self.rows
        return (down, across) if self.is_sideways else (across, down)

    def ratios(self, across: tuple[int, int], down: tuple[int, int]) -> tuple[tuple[int, int], tuple[int, int]]:
        """Fractions that state pixels per unit."""
        if self.is_sideways:
            across, down = down, across
        return scaled_ratio(*across, self.scale_x), scaled_ratio(*down, self.scale_y)

    def area(self, values: list[int]) -> list[int] | None:
        """A point, a circle by centre and diameter, or a rectangle by centre and size, as EXIF's SubjectArea has them;
        None for one that is outside, or none.
        """
        corner = self.point(*values[:2]) if len(values) in (2, 3, 4) else None
        if corner is None:
            return None
        size = self.size(values[2], values[-1]) if len(values) > 2 else ()
        return [*corner, *size[: len(values) - 2]]


def scaled_ratio(numerator: int, denominator: int, factor: float) -> tuple[int, int]:
    """A fraction of 32-bit numbers times a factor; one without a value stays so."""
    from fractions import Fraction  # takes long to load

    if denominator == 0 or factor == 1:
        return numerator, denominator
    scaled = (Fraction(numerator, denominator) * Fraction(factor)).limit_denominator(1 << 16)
    return min(scaled.numerator, (1 << 32) - 1), scaled.denominator
