"""The levels of a pyramid, as viewers of slides want them: each is half of the one before."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Level", "levels_of"]

SMALLEST_SIDE = 256
"""The last level is the first one whose longer side is no longer than this."""


class Level(NamedTuple):
    """Size in pixels, and how many of the picture's pixels lie along the side of one of its own."""

    width: int
    height: int
    downsample: float


def levels_of(width: int, height: int) -> tuple[Level, ...]:
    """The levels of a picture. Any of them is rendered from the model, or from the overview."""
    levels = [Level(width, height, 1.0)]
    while max(levels[-1][:2]) > SMALLEST_SIDE:
        shrink = 2 ** len(levels)
        small = max(1, round(width / shrink)), max(1, round(height / shrink))
        levels.append(Level(*small, (width / small[0] + height / small[1]) / 2))
    return tuple(levels)
