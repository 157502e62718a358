"""A quadtree of seeds: its shape, and which of its nodes carry seeds or are split.

A node of level k is a square of 2**k pixels; roots of level 6 tile the picture. A node may carry a
seed at its centre and may be split into four children; children that lie wholly outside the picture do not
exist. Each split node has a seed somewhere below it, so a tree has one spelling.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import MAX_SIDE
from sgicodec.errors import LimitError, UsageError
from sgicodec.model.distinct import distinct
from sgicodec.model.morton import Codes, morton

__all__ = ["MAX_ROOTS", "MIN_LOG", "ROOT_LOG", "Flags", "GivenTree", "Seeds", "TreeShape"]

Flags = NDArray[np.uint8]
Seeds = tuple[NDArray[np.int32], NDArray[np.int8]]
"""Corners [N, 2] in pixels (x, y) and log2 of the node size [N]."""

ROOT_LOG, MIN_LOG = 6, 1
"""log2 of the sides of roots and of the smallest nodes, pixels."""
MAX_ROOTS = 1 << 20
"""Four gigapixels in cells of 64, fewer if the picture is narrow."""


@dataclass(frozen=True)
class TreeShape:
    """The pixels that a tile's quadtree covers. Raises UsageError for what no tree can have."""

    width: int
    height: int

    def __post_init__(self) -> None:
        if not (1 <= self.width <= MAX_SIDE and 1 <= self.height <= MAX_SIDE):
            raise UsageError(f"positions: {self.width}×{self.height} pixels; sides must be 1..{MAX_SIDE}")

    @property
    def root_grid(self) -> tuple[int, int]:
        """Number of roots across and down."""
        side = 1 << ROOT_LOG
        return -(-self.width // side), -(-self.height // side)

    def check_roots(self) -> None:
        """Raises LimitError for more roots than any tree may have."""
        columns, rows = self.root_grid
        if columns * rows > MAX_ROOTS:
            raise LimitError(f"positions: {columns}×{rows} root nodes; at most {MAX_ROOTS} are allowed")


class GivenTree:
    """The tree of given seeds: which nodes of a level carry seeds, which are split."""

    def __init__(self, shape: TreeShape, seeds: Seeds) -> None:
        corner, log_size = np.asarray(seeds[0], np.int64).reshape(-1, 2), np.asarray(seeds[1], np.int64)
        if len(corner) != len(log_size):
            raise UsageError(f"positions: {len(corner)} corners, {len(log_size)} sizes; need as many of each")
        sized = (log_size >= MIN_LOG) & (log_size <= ROOT_LOG)
        inside = (corner >= 0) & (corner < (shape.width, shape.height))
        aligned = corner & ((1 << np.clip(log_size, 0, ROOT_LOG)) - 1)[:, None] == 0
        if not (sized.all() and inside.all() and aligned.all()):
            raise UsageError("positions: a seed is no node of the tree: outside, off its grid, of another size")
        code = morton(corner[:, 0], corner[:, 1])
        levels = range(MIN_LOG, ROOT_LOG + 1)
        self._seeds = {level: distinct(code[log_size == level] >> 2 * level) for level in levels}
        self._splits = {level: distinct(code[log_size < level] >> 2 * level) for level in levels}
        if sum(codes.size for codes in self._seeds.values()) != len(corner):
            raise UsageError("positions: two seeds share one node")

    def seed(self, level: int, codes: Codes) -> Flags:
        """1 where a node carries a seed."""
        return _occurs(codes, self._seeds[level])

    def split(self, level: int, codes: Codes) -> Flags:
        """1 where a node has seeds below it."""
        return _occurs(codes, self._splits[level])


def _occurs(values: Codes, ordered: Codes) -> Flags:
    """1 where a value is in an ordered array."""
    if ordered.size == 0:
        return np.zeros(values.size, np.uint8)
    index = np.minimum(np.searchsorted(ordered, values), ordered.size - 1)
    found: Flags = (ordered[index] == values).astype(np.uint8)
    return found
