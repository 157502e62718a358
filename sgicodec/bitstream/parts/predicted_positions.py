"""Seed positions as a quadtree whose flags are coded as a shipped network predicts them.

The network, one for each child number, sees what lies around a node, the base layer there, the quality and what share
of the file's flags was 1 so far. Its three outputs are the log-odds of a node being split, and of its carrying a seed
if it is not and if it is; they choose a row of a small table of probabilities. Native code goes through the tree, in
one way for writing, training and reading (native/bitstream/tree_walk.hpp).
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.alphabets import Alphabets
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.parts.positions import Seeds
from sgicodec.device import ONE_THREAD

__all__ = ["TreeContext", "write_predicted_positions"]


class TreeContext(NamedTuple):
    """What a prediction sees besides the tree: width and height of the tile, its base layer [C, rows, columns] in cells
    of `cell` pixels (0: none), and the header's quality.
    """

    size: tuple[int, int]
    base: NDArray[np.int64]
    cell: int
    quality: int


def write_predicted_positions(writer: SymbolWriter, tree_context: TreeContext, seeds: Seeds) -> None:
    """Writes `seeds`. Raises UsageError for seeds that are no nodes of the tree, or share one."""
    for flags, rows in _native.position_flags(*tree_context, *seeds, ONE_THREAD.threads, ONE_THREAD.isa):
        writer.code_categorical(flags, _alphabets(), rows)


@cache
def _alphabets() -> Alphabets:
    return Alphabets(_native.flag_frequencies())
