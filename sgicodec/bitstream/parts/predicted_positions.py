"""Seed positions as a quadtree whose flags are coded as a shipped network predicts them.

The network (`positions1.bin`, one for each child number) sees what lies around a node, the base layer there, the
quality and what share of the file's flags was 1 so far. Its three outputs are the log-odds of a node being split, and
of its carrying a seed if it is not and if it is; they choose a row of a small table of probabilities.
"""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import TreeNetwork
from sgicodec.bitstream.entropy.alphabets import Alphabets
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import TOTAL
from sgicodec.bitstream.parts.predicted_tree import LEVELS, Batch, TreeContext, input_counts, walk_tree
from sgicodec.bitstream.parts.prior import parse_prior
from sgicodec.bitstream.parts.seed_tree import Flags, GivenTree, Seeds, TreeShape
from sgicodec.device import ONE_THREAD
from sgicodec.errors import UnsupportedStreamError
from sgicodec.model.network import IntNetwork

__all__ = ["ONES", "write_predicted_positions"]

SHA256 = "cea8d9a268ade90a019ca4bf78ddca68f764b3e7c45010a487a8a041b0fe7f3a"

ONES = (
    *(32768, 36843, 40793, 44511, 47911, 50941, 53581, 55834, 57724, 59287, 60565, 61598, 62428),
    *(63090, 63615, 64030, 64357, 64614, 64816, 64974, 65097, 65194, 65269, 65328, 65374),
)
"""P(flag = 1) · 65536 at log-odds 0, 1/4, 2/4 … 6."""

_MAX_ONES = len(ONES) - 1
_CERTAIN = 2 * _MAX_ONES + 1
_PER_ROW = 6
"""log2 of the units of log-odds, 1/256 each, that a row stands for."""


def write_predicted_positions(writer: SymbolWriter, shape: TreeShape, tree_context: TreeContext, seeds: Seeds) -> None:
    """Writes `seeds`. Raises UsageError for seeds that are no nodes of the tree."""
    given_tree = GivenTree(shape, seeds)
    networks = _native_networks(ONE_THREAD.isa)

    def flags(given: Flags, rows: NDArray[np.int16]) -> Flags:
        writer.code_categorical(given, _alphabets(), rows)
        return given

    def code(batch: Batch) -> tuple[Flags, Flags]:
        rows = batch.rows(networks[batch.child], _PER_ROW, _MAX_ONES, ONE_THREAD.threads)
        split = np.zeros(len(batch), np.uint8)
        if batch.level > LEVELS[-1]:
            split = flags(given_tree.split(batch.level, batch.codes), rows[:, 0])
        return split, flags(given_tree.seed(batch.level, batch.codes), batch.seed_rows(rows, split, _CERTAIN))

    walk_tree(shape, tree_context, code, len(seeds[1]))


@cache
def _alphabets() -> Alphabets:
    """Rows of log-odds −6 … 6, and that of a flag that is 1 in any case."""
    ones = [65536 - one for one in ONES[:0:-1]] + [*ONES, 65536]
    return Alphabets(np.array([[65536 - one, one] for one in ones], np.int64) * (TOTAL >> 16))


@cache
def _native_networks(isa: str) -> tuple[TreeNetwork, ...]:
    """Ready for one instruction set; the outputs are all log-odds."""
    return tuple(
        TreeNetwork(net.w1, net.b1, net.w2, net.b2, net.shift, child, isa) for child, net in enumerate(_networks())
    )


@cache
def _networks() -> tuple[IntNetwork, ...]:
    data = files("sgicodec.bitstream.parts").joinpath("positions1.bin").read_bytes()
    if hashlib.sha256(data).hexdigest() != SHA256:
        raise UnsupportedStreamError("positions1.bin of this installation is damaged; install the package again")
    networks = parse_prior(data)
    if tuple(network.w1.shape[1] for network in networks) != input_counts():
        raise UnsupportedStreamError("positions1.bin does not fit this version; install the package again")
    return networks
