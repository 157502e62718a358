"""Windows that cover a picture, as an encode reads it."""

from __future__ import annotations

import itertools
from collections.abc import Iterator


def window_rows(width: int, height: int, tile: int, apron: int) -> Iterator[tuple[int, int, int, int]]:
    """x, y, width and height of every tile with its apron, row by row."""
    for y, x in itertools.product(range(0, height, tile), range(0, width, tile)):
        left, top = max(x - apron, 0), max(y - apron, 0)
        yield left, top, min(x + tile + apron, width) - left, min(y + tile + apron, height) - top
