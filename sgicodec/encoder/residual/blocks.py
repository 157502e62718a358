"""Blocks of a picture, and what is counted of their pixels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.header import Header
from sgicodec.model.tile_grid import Rect

_MAX_JUDGED = 12
"""Blocks by which a picture is judged."""


def block_rects(header: Header) -> Iterator[Rect]:
    """The blocks of a picture, in rows."""
    side = _native.RESIDUAL_BLOCK
    for y in range(0, header.height, side):
        for x in range(0, header.width, side):
            yield x, y, min(side, header.width - x), min(side, header.height - y)


def judged_rects(header: Header) -> Sequence[Rect]:
    """The blocks of a picture by which it is judged."""
    return some_of(list(block_rects(header)))


def some_of(rects: Sequence[Rect]) -> Sequence[Rect]:
    """A few of these blocks, evenly spread."""
    return rects[:: -(-len(rects) // _MAX_JUDGED) or 1]


class Repeats:
    """How many pixels there are, and how many are others than the one to their left."""

    def __init__(self) -> None:
        self.pixels = self.others = 0

    def see(self, pixels: NDArray[Any], among: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
        """More pixels [h, w, C], of which those `among` count, by default all; gives which are not [h, w]."""
        others = np.ones(pixels.shape[:2], np.bool_)
        others[:, 1:] = False
        for channel in range(pixels.shape[2]):
            others[:, 1:] |= pixels[:, 1:, channel] != pixels[:, :-1, channel]
        if among is not None:
            others &= among
        self.pixels += others.size if among is None else int(np.count_nonzero(among))
        self.others += int(np.count_nonzero(others))
        return others

    @property
    def are_usual(self) -> bool:
        """Whether more than half are, as in text, line art and screens."""
        return 2 * self.others < self.pixels


class DistinctPixels:
    """Pixels that differ from each other, while there are no more than `most`; all that are no numbers are one."""

    def __init__(self, most: int) -> None:
        self._most = most
        self.known: NDArray[Any] = np.zeros((0, 0))
        """[n, C], of all that were seen if they are few."""

    def see(self, pixels: NDArray[Any]) -> bool:
        """More pixels [n, C]; whether they are few still."""
        if len(self.known) <= self._most:
            values = np.concatenate([self.known, pixels]) if self.known.size else pixels
            if values.shape[1] == 1:
                self.known = np.unique(values)[:, None]
            else:
                self.known = np.unique(
                    np.nan_to_num(values, nan=np.inf) if values.dtype.kind == "f" else values, axis=0
                )
        return len(self.known) <= self._most
