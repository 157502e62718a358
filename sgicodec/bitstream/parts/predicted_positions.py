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

from sgicodec._native import RangeDecoder, TreeNetwork, read_tree
from sgicodec.bitstream.entropy.alphabets import Alphabets
from sgicodec.bitstream.entropy.symbol_coder import IntArray, SymbolCoder, SymbolReader
from sgicodec.bitstream.entropy.tables import TOTAL
from sgicodec.bitstream.parts.predicted_tree import (
    LEVELS,
    Batch,
    TreeContext,
    input_counts,
    limited,
    native_tree_context,
    walk_tree,
)
from sgicodec.bitstream.parts.prior import parse_prior
from sgicodec.bitstream.parts.seed_tree import Flags, GivenTree, Seeds, TreeShape, seeds_of
from sgicodec.device import ONE_THREAD, Device
from sgicodec.errors import UnsupportedStreamError, UsageError
from sgicodec.model.morton import Codes
from sgicodec.model.network import IntNetwork

__all__ = ["ONES", "code_predicted_positions"]

SHA256 = "cea8d9a268ade90a019ca4bf78ddca68f764b3e7c45010a487a8a041b0fe7f3a"

ONES = (
    *(32768, 36843, 40793, 44511, 47911, 50941, 53581, 55834, 57724, 59287, 60565, 61598, 62428),
    *(63090, 63615, 64030, 64357, 64614, 64816, 64974, 65097, 65194, 65269, 65328, 65374),
)
"""P(flag = 1) · 65536 at log-odds 0, 1/4, 2/4 … 6."""

_MOST = len(ONES) - 1
_CERTAIN = 2 * _MOST + 1
_PER_ROW = 6
"""log2 of the units of log-odds, 1/256 each, that a row stands for."""


def code_predicted_positions(
    coder: SymbolCoder,
    shape: TreeShape,
    tree_context: TreeContext,
    seeds: Seeds | None,
    max_seeds: int,
    device: Device = ONE_THREAD,
) -> Seeds:
    """Writes `seeds`, or reads them if None; returns them in `canonical_order` either way.

    Raises UsageError for seeds that are no nodes of the tree, LimitError for a tree of more than `max_seeds` seeds,
    before anything of that size is allocated.
    """
    if seeds is None and isinstance(coder, SymbolReader):
        return _read(coder, shape, tree_context, max_seeds, device)
    if seeds is None:
        raise UsageError("positions: a writer needs seeds")
    given_tree = GivenTree(shape, seeds, max_seeds)
    networks = _native_networks(device.isa)

    def flags(given: Flags, rows: NDArray[np.int16]) -> Flags:
        return coder.code_categorical(given, _alphabets(), rows).astype(np.uint8)

    def code(batch: Batch) -> tuple[Flags, Flags]:
        rows = batch.rows(networks[batch.child], _PER_ROW, _MOST, device.threads)
        split = np.zeros(len(batch), np.uint8)
        if batch.level > LEVELS[-1]:
            split = flags(given_tree.split(batch.level, batch.codes), rows[:, 0])
        return split, flags(given_tree.seed(batch.level, batch.codes), batch.seed_rows(rows, split, _CERTAIN))

    return seeds_of(walk_tree(shape, tree_context, code, max_seeds))


def _read(coder: SymbolReader, shape: TreeShape, tree_context: TreeContext, max_seeds: int, device: Device) -> Seeds:
    """The whole tree in one native call, which lets other threads run."""
    native, networks, alphabets = native_tree_context(shape, tree_context), _native_networks(device.isa), _alphabets()
    known = alphabets.models, alphabets.symbol, alphabets.bits
    found: list[tuple[Codes, int]] = []

    def read(decoder: RangeDecoder) -> tuple[int, IntArray, list[float]]:
        decodes, codes, symbols, bits = limited(
            lambda: read_tree(decoder, native, max_seeds, networks, *known, _PER_ROW, _MOST, device.threads)
        )
        found.extend(codes)
        return int(not decodes), symbols, [bits]

    coder.read(read, [coder.current])
    return seeds_of(found)


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
