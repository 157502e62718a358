"""Seed positions as a quadtree (`seed_tree`), coded level by level under probabilities that the stream states.

Levels are coded from the roots down, and within a level the children number 0, 1, 2, 3 of all split nodes,
one number after the other. When a child is coded its parent's level is thus complete, and so are the earlier
children of the whole level: half of its neighbours. Their splits predict its own; on adaptive trees this
context takes a fifth off what the parent level alone gives. The probability of each context is sent in four
bits where the context first occurs; small trees merge contexts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.alphabets import Alphabets
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import TOTAL, bits_of_frequencies
from sgicodec.bitstream.parts.seed_tree import Flags, GivenTree, Seeds, TreeShape
from sgicodec.model.morton import Codes, morton

__all__ = ["write_positions"]

Contexts = NDArray[np.int16]

ONES = (0, 3, 6, 11, 21, 38, 67, 106, 150, 189, 218, 235, 245, 250, 253, 256)
"""P(flag = 1) · 256 for each 4-bit code: equal steps of log-odds, and "never" and "always" at the ends."""

_FLAGS = Alphabets(np.array([[256 - one, one] for one in ONES], np.int64) * (TOTAL // 256))  # [16, 2]

SCORE_SHIFTS = (0, 1, 2, 4)
"""By how much neighbour scores are shifted: small trees cannot pay for the probabilities of all contexts."""

_SIBLINGS = 8
"""Contexts from earlier siblings: 2 · number empty (0..3) + (any occupied)."""

_SPLIT_CONTEXTS = 9 * _SIBLINGS
_SEED_CONTEXTS = 4 * _SIBLINGS

_DIRECTIONS = ((-1, 0), (1, 0), (0, -1), (0, 1))


def write_positions(writer: SymbolWriter, shape: TreeShape, seeds: Seeds) -> None:
    """Writes `seeds`. Raises UsageError for seeds that are no nodes of the tree."""
    shape.check_roots()
    tree = GivenTree(shape, seeds)
    counter = _FlagCounter(shape)
    _traverse(shape, counter, tree)
    detail, best = counter.best()
    writer.code_int(detail, 2)
    _traverse(shape, _StatedFlagWriter(writer, _merged_contexts(shape, detail), best), tree)


class _FlagTaker(Protocol):
    def take(self, contexts: Contexts, flags: Flags) -> None:
        """Takes one flag per context."""


class _FlagCounter:
    """Counts zeros and ones per context."""

    def __init__(self, shape: TreeShape) -> None:
        self._shape = shape
        self._counts = np.zeros((_context_count(shape), 2), np.int64)

    def take(self, contexts: Contexts, flags: Flags) -> None:
        self._counts += np.bincount(2 * contexts.astype(np.int64) + flags, minlength=self._counts.size).reshape(-1, 2)

    def best(self) -> tuple[int, NDArray[np.int64]]:
        """The detail of contexts that costs least, with the probability code of each context under it."""
        bits = np.minimum(bits_of_frequencies(_FLAGS.frequencies), 1e9)  # impossible, but 0 · ∞ is not a number
        trials = []
        for detail in range(len(SCORE_SHIFTS)):
            counts = np.zeros_like(self._counts)
            np.add.at(counts, _merged_contexts(self._shape, detail), self._counts)
            costs = counts @ bits.T  # [contexts, 16]
            total = costs.min(axis=1).sum() + 4 * np.count_nonzero(counts.any(axis=1))
            trials.append((float(total), detail, np.argmin(costs, axis=1)))
        return min(trials, key=lambda trial: trial[:2])[1:]


class _StatedFlagWriter:
    """Writes flags under the probability of their context, which is sent before the first flag it is for."""

    def __init__(self, writer: SymbolWriter, merged: NDArray[np.int64], best: NDArray[np.int64]) -> None:
        self._writer = writer
        self._merged = merged
        self._best = best
        self._sent = np.full(merged.size, -1, np.int16)

    def take(self, contexts: Contexts, flags: Flags) -> None:
        merged = self._merged[contexts]
        occurring = np.flatnonzero(np.bincount(merged, minlength=self._sent.size))
        fresh = occurring[self._sent[occurring] < 0]
        self._sent[fresh] = self._best[fresh]
        self._writer.code_bits(self._best[fresh], 4)
        self._writer.code_categorical(flags, _FLAGS, self._sent[merged])


def _context_count(shape: TreeShape) -> int:
    return _SEED_CONTEXTS + (shape.root_log - shape.min_log + 1) * _SPLIT_CONTEXTS


def _merged_contexts(shape: TreeShape, detail: int) -> NDArray[np.int64]:
    """The context that stands for each context once scores are shifted by SCORE_SHIFTS[detail]."""
    context = np.arange(_context_count(shape))
    level, rest = np.divmod(context - _SEED_CONTEXTS, _SPLIT_CONTEXTS)
    score, siblings = np.divmod(rest, _SIBLINGS)
    shifted = score >> SCORE_SHIFTS[detail]
    merged = _SEED_CONTEXTS + level * _SPLIT_CONTEXTS + shifted * _SIBLINGS + siblings
    return np.where(context < _SEED_CONTEXTS, context, merged)


def _traverse(shape: TreeShape, taker: _FlagTaker, tree: GivenTree) -> None:
    """Goes through the tree, batch by batch."""
    columns, rows = shape.root_grid
    y, x = np.divmod(np.arange(columns * rows), columns)
    order = np.argsort(morton(x, y), kind="stable")
    roots = morton(x, y)[order]
    unknown = np.zeros(roots.size, np.int16)
    _, split = _take_nodes(shape, taker, tree, shape.root_log, roots, unknown, unknown)
    parents = _Parents.of_roots(x[order], y[order], split)
    for level in range(shape.root_log - 1, shape.min_log - 1, -1):
        parents = _take_level(shape, taker, tree, level, parents)


@dataclass(frozen=True)
class _Parents:
    """The split nodes of one level by ascending Morton code: their coordinates [P] in nodes, and for each of the four
    directions the index of the neighbour among them [P], −1 where it is not split or not there.
    """

    x: Codes
    y: Codes
    beside: dict[tuple[int, int], Codes]

    def __len__(self) -> int:
        return len(self.x)

    @classmethod
    def of_roots(cls, x: Codes, y: Codes, split: Flags) -> _Parents:
        """Those of the roots (all of a grid) that are split."""
        x, y = x[split == 1], y[split == 1]
        number = np.full((int(y.max(initial=0)) + 3, int(x.max(initial=0)) + 3), -1)
        number[y + 1, x + 1] = np.arange(len(x))
        return cls(x, y, {(dx, dy): number[y + 1 + dy, x + 1 + dx] for dx, dy in _DIRECTIONS})

    def children(self, split: Flags) -> _Parents:
        """Those of their children that are split, split [P, 4]: neighbours are children of the same or a neighbour."""
        found = np.flatnonzero(split)
        parent, child = found >> 2, found & 3
        number = np.full(4 * (len(self) + 1), -1)  # the last four are children of neighbours that are not there
        number[found] = np.arange(len(found))
        beside = {}
        for dx, dy in _DIRECTIONS:
            half = child & 1 if dx else child >> 1
            within = half + dx + dy == half ^ 1
            where = np.where(within, parent, self.beside[dx, dy][parent])
            beside[dx, dy] = number[4 * where + (child ^ (1 if dx else 2))]
        return _Parents(2 * self.x[parent] + (child & 1), 2 * self.y[parent] + (child >> 1), beside)


def _take_level(shape: TreeShape, taker: _FlagTaker, tree: GivenTree, level: int, parents: _Parents) -> _Parents:
    """The children of `parents`: those that are split."""
    count = len(parents)
    codes = 4 * morton(parents.x, parents.y)
    split = np.zeros((count + 1, 4), np.uint8)  # the last row is that of neighbours that are not there
    empty, occupied = np.zeros(count, np.uint8), np.zeros(count, np.uint8)
    for child in range(4):
        right, down = child & 1, child >> 1
        inside = (2 * parents.x + right << level < shape.width) & (2 * parents.y + down << level < shape.height)
        exists = slice(None) if inside.all() else np.flatnonzero(inside)
        score = _score(split, parents, child)[exists]
        siblings = (2 * empty + occupied)[exists].astype(np.int16)
        here = _take_nodes(shape, taker, tree, level, codes[exists] + child, score, siblings)
        split[:count][exists, child] = here[1]
        taken = here[0] | here[1]
        empty[exists] += taken ^ 1
        occupied[exists] |= taken
    return parents.children(split[:count])


def _score(split: Flags, parents: _Parents, child: int) -> NDArray[np.int16]:
    """Sum over the four neighbours of child number `child` of each parent: 2 for one known to be split, 1 for
    one not coded yet whose parent is split, else 0.
    """
    score = np.zeros(len(parents), np.int16)
    for (dx, dy), index in parents.beside.items():
        half = child & 1 if dx else child >> 1
        other = child ^ (1 if dx else 2)
        if half + dx + dy in (0, 1):  # the neighbour has the same parent
            score += 2 * split[:-1, other] if other < child else 1
        else:
            score += 2 * split[index, other] if other < child else index >= 0
    return score


def _take_nodes(
    shape: TreeShape,
    taker: _FlagTaker,
    tree: GivenTree,
    level: int,
    codes: Codes,
    score: NDArray[np.int16],
    siblings: NDArray[np.int16],
) -> tuple[Flags, Flags]:
    """The two flags of nodes of one level, whether each carries a seed and whether it is split, which comes first."""
    split = np.zeros(codes.size, np.uint8)
    if level > shape.min_log:
        first = _SEED_CONTEXTS + (level - shape.min_log) * _SPLIT_CONTEXTS
        split = tree.split(level, codes)
        taker.take(np.int16(first) + np.int16(_SIBLINGS) * score + siblings, split)
    kind = 2 * (level == shape.min_log) + split
    seed = tree.seed(level, codes)
    taker.take(np.int16(_SIBLINGS) * kind + siblings, seed)
    return seed, split
