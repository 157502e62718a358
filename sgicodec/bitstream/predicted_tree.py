"""The tree of seeds batch by batch, with what a prediction of its flags may see (docs/format.md, "Predicted flags").

Roots are the children of nodes one level up that are all split, so that all nodes are coded alike. A level is coded
in four batches, child number after child number in the order of `CHILDREN`: diagonal ones first, so that the other two
have neighbours on all four sides that are known.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.seed_tree import Flags, TreeShape
from sgicodec.errors import LimitError, UsageError
from sgicodec.model.morton import Codes, morton

__all__ = ["CHILDREN", "LEVELS", "Batch", "Scenery", "input_counts", "walk_tree"]

I16 = NDArray[np.int16]
I32 = NDArray[np.int32]

CHILDREN = (0, 3, 1, 2)
LEVELS = range(6, 0, -1)
"""Levels of the trees whose flags are predicted, roots first."""

_SIDES = ((-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1))
_ABOVE, _DETAIL = 1 + 3 * len(_SIDES) + 6, 5
_ONE = 64


@dataclass(frozen=True)
class Scenery:
    """What a prediction sees besides the tree: base layer [C, rows, columns] in cells of `cell` pixels (0: none), and
    the header's quality.
    """

    base: NDArray[np.int64]
    cell: int
    quality: int

    @property
    def detail(self) -> I16:
        """How much the base layer varies at each cell [rows, columns, 5], sixteenths of an octave."""
        out = np.zeros((*self.base.shape[1:], _DETAIL), np.int16)
        if self.cell:
            _native.base_detail(np.ascontiguousarray(self.base, np.int64), out)
        return out


class Batch:
    """Nodes of one level and child number that are coded together; needed [n]: which must not be empty, being the last
    of their parent's children where the others are.
    """

    def __init__(self, level: _Level, child: int, members: I32, needed: NDArray[np.bool_], head: I16) -> None:
        self.level, self.child, self.needed = level.level, child, needed
        self.members, self._of, self._head = members, level, head

    def __len__(self) -> int:
        return len(self.members)

    @property
    def codes(self) -> Codes:
        """Morton codes [n] at their level."""
        parents = self._of.parents
        return 4 * morton(parents.x[self.members], parents.y[self.members]) + self.child

    @property
    def inputs(self) -> I16:
        """What a prediction sees [n, inputs], in 1/64."""
        out = np.empty((len(self), input_counts()[self.child]), np.int16)
        parents, slots, detail, cell = self._of.seen
        _native.tree_inputs(parents, slots, detail, cell, self._head, self.level, self.child, self.members, out)
        return out

    def rows(self, network: _native.TreeNetwork, shift: int, most: int, threads: int) -> I16:
        """What the network of this child number says [n, outputs]: log-odds in units of 2^(shift − 8), clipped to ±most
        and moved by `most`.
        """
        out = np.empty((len(self), 3), np.int16)
        parents, slots, detail, cell = self._of.seen
        network.rows(parents, slots, detail, cell, self._head, self.level, self.members, shift, most, threads, out)
        return out


@cache
def input_counts() -> tuple[int, ...]:
    """Inputs by child number."""
    return tuple(_native.tree_input_count(child) for child in range(4))


def walk_tree(
    shape: TreeShape, scenery: Scenery, code: Callable[[Batch], tuple[Flags, Flags]], max_seeds: int
) -> list[tuple[Codes, int]]:
    """Goes through a tree; `code` says of each batch which nodes are split and which carry seeds. Returns the Morton
    codes of the nodes that carry seeds, with their level.

    Raises LimitError before anything of the size of more than `max_seeds` seeds is allocated.
    """
    if (shape.root_log, shape.min_log) != (LEVELS[0], LEVELS[-1]):
        raise UsageError(f"positions: trees of levels {shape.min_log} to {shape.root_log} have no prediction")
    shape.check_roots()
    detail, rates = scenery.detail, _Rates()
    parents = _above_roots(shape)
    found: list[tuple[Codes, int]] = []
    for log_size in LEVELS:
        if log_size < LEVELS[0] and max(len(parents.x), sum(codes.size for codes, _ in found)) > max_seeds:
            raise LimitError(f"positions: more than {max_seeds} seeds at level {log_size + 1}")
        level = _Level(log_size, shape, parents, (detail, max(1, scenery.cell)))
        rates.next_level()
        for child in CHILDREN:
            batch = level.batch(child, scenery.quality, rates)
            split, seed = code(batch)
            level.take(batch, split, seed)
            rates.count(split, seed, has_split=log_size > LEVELS[-1])
        found.append((level.seeds(), log_size))
        parents = level.children()
    if sum(codes.size for codes, _ in found) > max_seeds:
        raise LimitError(f"positions: more than {max_seeds} seeds")
    return found


@dataclass(frozen=True)
class _Split:
    """The split nodes of one level by ascending Morton code: coordinates [P] in nodes, the index of each neighbour
    among them [P, 8] (P: none), and what they add to the inputs of their children [P, 31].
    """

    x: I32
    y: I32
    neighbour: I32
    above: I16

    @classmethod
    def empty(cls, count: int) -> _Split:
        x, y, neighbour = (np.empty(shape, np.int32) for shape in (count, count, (count, len(_SIDES))))
        return cls(x, y, neighbour, np.zeros((count, _ABOVE), np.int16))

    @property
    def arrays(self) -> tuple[I32, I32, I32, I16]:
        """As native code takes them."""
        return self.x, self.y, self.neighbour, self.above


def _above_roots(shape: TreeShape) -> _Split:
    """The parents of the roots."""
    columns, rows = (-(-count // 2) for count in shape.root_grid)
    y, x = np.divmod(np.arange(columns * rows), columns)
    order = np.argsort(morton(x, y), kind="stable")
    nodes = _Split.empty(order.size)
    nodes.x[:], nodes.y[:] = x[order], y[order]
    number = np.full((rows + 2, columns + 2), order.size, np.int32)
    number[nodes.y + 1, nodes.x + 1] = np.arange(order.size)
    for side, (dx, dy) in enumerate(_SIDES):
        nodes.neighbour[:, side] = number[nodes.y + 1 + dy, nodes.x + 1 + dx]
        there = nodes.neighbour[:, side] < order.size
        nodes.above[:, 1 + 3 * side] = nodes.above[:, 3 + 3 * side] = _ONE * there  # split and existing
    return nodes


class _Rates:
    """Which share of a file's flags was 1 so far, in 1/64: on the level before and on this one."""

    def __init__(self) -> None:
        self._now = np.zeros((2, 2), np.int64)  # flags, ones of split flags and of seed flags of nodes that are not
        self._before = np.zeros((2, 2), np.int64)

    def next_level(self) -> None:
        self._before, self._now = self._now, np.zeros((2, 2), np.int64)

    def count(self, split: Flags, seed: Flags, has_split: bool) -> None:
        unsplit = split.size - int(split.sum())
        self._now[0] += (split.size, split.size - unsplit) if has_split else (0, 0)
        self._now[1] += unsplit, int(seed.sum()) - int((seed & split).sum())

    def inputs(self) -> list[int]:
        rates = []
        for (count, ones), (count_before, ones_before) in zip(self._now, self._before, strict=True):
            before = (64 * int(ones_before) + 32) // (int(count_before) + 1)
            rates += [before, (64 * int(ones) + 16 * before) // (int(count) + 16)]
        return [2 * rate for rate in rates]


class _Level:
    """The children of all split nodes of one level, four slots for each, and a last row for what is not there."""

    def __init__(self, level: int, shape: TreeShape, parents: _Split, detail: tuple[I16, int]) -> None:
        self.level, self.parents, self._detail = level, parents, detail
        count = len(parents.x)
        self._exists, self._flags = np.zeros((count + 1, 4), np.uint8), np.zeros((count + 1, 4, 2), np.int16)
        self._occupied = np.full(count, level == LEVELS[0], np.uint8)  # roots may all be empty
        _native.children_inside(parents.arrays, level, shape.width, shape.height, self._exists)

    @property
    def seen(self) -> tuple[tuple[I32, I32, I32, I16], tuple[Flags, I16], I16, int]:
        """What predictions of all batches see, as native code takes it."""
        return self.parents.arrays, (self._exists, self._flags), *self._detail

    def batch(self, child: int, quality: int, rates: _Rates) -> Batch:
        """The nodes of one child number."""
        room = len(self._exists)
        members, needed = np.empty(room, np.int32), np.empty(room, np.uint8)
        count = _native.begin_batch(self._exists, self._occupied, child, members, needed)
        levels = [_ONE * (self.level == LEVELS[-1] + i) for i in range(len(LEVELS))]
        head = np.array([*levels, quality, *rates.inputs()], np.int16)
        return Batch(self, child, members[:count], needed[:count].astype(bool), head)

    def take(self, batch: Batch, split: Flags, seed: Flags) -> None:
        """Keeps the flags of a batch."""
        _native.end_batch(batch.members, batch.child, split, seed, self._flags, self._occupied)

    def seeds(self) -> Codes:
        """Morton codes of the nodes that carry seeds."""
        found = np.flatnonzero(self._flags[..., 1])
        return 4 * morton(self.parents.x[found >> 2], self.parents.y[found >> 2]) + (found & 3)

    def children(self) -> _Split:
        """Those that are split."""
        found = np.flatnonzero(self._flags[..., 0]).astype(np.int32)
        nodes = _Split.empty(found.size)
        number = np.empty(self._exists.shape, np.int32)
        _native.split_children(self.parents.arrays, (self._exists, self._flags), found, number, *nodes.arrays)
        return nodes
