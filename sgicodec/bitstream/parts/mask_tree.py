"""The mask tree: which pixels of a tile hold nothing, as the quadtree that the stream codes, never expanded unasked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["BEYOND", "CLEAR", "SET", "MaskTree"]

Mask = NDArray[np.bool_]
Links = NDArray[np.int32]

CLEAR, SET, BEYOND = -1, -2, -3
"""What a link says instead of a node's number: all pixels hold something, none does, or there are none."""


@dataclass(frozen=True, eq=False)
class MaskTree:
    """levels: from the root's children down to pixels, the links [n, 4] of the mixed nodes above: a child's number
    among the mixed nodes of its level, or CLEAR, SET, BEYOND. Without levels all pixels hold nothing.
    """

    width: int
    height: int
    levels: Sequence[Links] = ()

    @property
    def nbytes(self) -> int:
        """Bytes of memory."""
        return sum(level.nbytes for level in self.levels)

    @property
    def is_mixed(self) -> bool:
        """Whether some pixels hold something and others nothing."""
        return all(any((level == link).any() for level in self.levels) for link in (CLEAR, SET))

    def at(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> Mask:
        """The mask [rows, columns] where rows and columns of pixels meet. Takes a few times what the result takes."""
        if not self.levels:
            return np.ones((len(rows), len(columns)), np.bool_)
        empty, ys, xs = np.zeros((1, 1), np.bool_), np.zeros(1, np.int64), np.zeros(1, np.int64)
        node, top, left = np.zeros((3, 1), np.int64)  # mixed nodes that hold some of these pixels, and their places
        for level, children in zip(range(len(self.levels) - 1, -1, -1), self.levels, strict=True):
            y, x = np.unique(rows >> level), np.unique(columns >> level)
            empty = _stretched(empty, np.searchsorted(ys, y >> 1), np.searchsorted(xs, x >> 1))
            links = children[node]
            below, right = 2 * top[:, None] + (0, 0, 1, 1), 2 * left[:, None] + (0, 1, 0, 1)
            i, j = np.searchsorted(y, below), np.searchsorted(x, right)
            seen = (y[np.minimum(i, len(y) - 1)] == below) & (x[np.minimum(j, len(x) - 1)] == right)
            nothing, mixed = seen & (links == SET), seen & (links >= 0)
            empty[i[nothing], j[nothing]] = True
            node, top, left = links[mixed], below[mixed], right[mixed]
            ys, xs = y, x
        if np.array_equal(ys, rows) and np.array_equal(xs, columns):
            return empty
        return _stretched(empty, np.searchsorted(ys, rows), np.searchsorted(xs, columns))

    def pixels(self) -> Mask:
        """The whole mask [height, width]."""
        return self.at(np.arange(self.height), np.arange(self.width))


def _stretched(mask: Mask, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> Mask:
    return mask.take(rows, axis=0).take(columns, axis=1)
