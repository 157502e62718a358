"""The quadtree of seeds in batches, and the inputs of the network that predicts its flags.

docs/format.md, "Predicted flags", defines both.

Roots are the children of nodes one level up that are all split, so that all nodes are coded alike. A level is coded in
four batches, child number after child number. The traversal (`native/bitstream/tree_walk.cpp`) is the same for writing,
training and reading.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec._native import TreeBatch as Batch
from sgicodec.bitstream.parts.seed_tree import MIN_LOG, ROOT_LOG, Flags, TreeShape

__all__ = ["LEVELS", "Batch", "TreeContext", "input_counts", "native_tree_context", "walk_tree"]

LEVELS = range(ROOT_LOG, MIN_LOG - 1, -1)
"""Levels of the tree, roots first."""


@dataclass(frozen=True)
class TreeContext:
    """What a prediction sees besides the tree: base layer [C, rows, columns] in cells of `cell` pixels (0: none), and
    the header's quality.
    """

    base: NDArray[np.int64]
    cell: int
    quality: int


@cache
def input_counts() -> tuple[int, ...]:
    """Inputs by child number."""
    return tuple(_native.tree_input_count(child) for child in range(4))


def native_tree_context(shape: TreeShape, tree_context: TreeContext) -> _native.TreeScenery:
    """Both as native code takes them. Raises LimitError for more roots than any tree may have."""
    shape.check_roots()
    base = np.ascontiguousarray(tree_context.base, np.int64)
    return _native.TreeScenery(shape.width, shape.height, base, tree_context.cell, tree_context.quality)


def walk_tree(
    shape: TreeShape, tree_context: TreeContext, code: Callable[[Batch], tuple[Flags, Flags]], max_seeds: int
) -> None:
    """Goes through a tree; `code` says of each batch which nodes are split and which carry seeds.

    Raises LimitError before anything of the size of more than `max_seeds` seeds is allocated.
    """
    _native.walk_tree(native_tree_context(shape, tree_context), max_seeds, code)
