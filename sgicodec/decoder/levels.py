"""The levels of a pyramid, as viewers of slides want them: each is half of the one before."""

from __future__ import annotations

from typing import NamedTuple

from sgicodec._native import levels


class Level(NamedTuple):
    """Size in pixels, and how many of the picture's pixels lie along the side of one of its own."""

    width: int
    height: int
    downsample: float


def levels_of(width: int, height: int) -> tuple[Level, ...]:
    """The levels of a picture. Any of them is rendered from the model, or from the overview."""
    return tuple(Level(*level) for level in levels(width, height))
