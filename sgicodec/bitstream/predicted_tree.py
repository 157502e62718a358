"""The tree of seeds batch by batch, with what a prediction of its flags may see (docs/format.md, "Predicted flags").

Roots are the children of nodes one level up that are all split, so that all nodes are coded alike. A level is coded
in four batches, child number after child number in the order of `CHILDREN`: diagonal ones first, so that the other two
have neighbours on all four sides that are known.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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
_BESIDE, _AROUND, _DETAIL = 1 + 3 * len(_SIDES), 6, 5
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
        """How much the base layer varies at each cell [rows, columns, 5], eighths of an octave."""
        out = np.zeros((*self.base.shape[1:], _DETAIL), np.int16)
        if self.cell:
            _native.base_detail(np.ascontiguousarray(self.base, np.int64), out)
        return out


@dataclass(frozen=True)
class Batch:
    """Nodes that are coded together: Morton codes [n] at their level, inputs [n, inputs] of the prediction, and which
    must not be empty [n] because all of their siblings are.
    """

    level: int
    child: int
    codes: Codes
    inputs: I16
    needed: NDArray[np.bool_]


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
    walk = _Walk(shape, scenery, code)
    parents = _above_roots(shape)
    found: list[tuple[Codes, int]] = []
    for level in LEVELS:
        if level < LEVELS[0] and max(len(parents.x), sum(codes.size for codes, _ in found)) > max_seeds:
            raise LimitError(f"positions: more than {max_seeds} seeds at level {level + 1}")
        seeds, parents = walk.level(level, parents)
        found.append((seeds, level))
    if sum(codes.size for codes, _ in found) > max_seeds:
        raise LimitError(f"positions: more than {max_seeds} seeds")
    return found


@dataclass(frozen=True)
class _Split:
    """The split nodes of one level by ascending Morton code: coordinates [P] in nodes, the index of each neighbour
    among them [P, 8] (P: none), seed and (split, seed, exists) of the neighbours [P, 25], and of the parent and its
    parent (seed, splits in 3×3 nodes, seeds there) [P, 6].
    """

    x: I32
    y: I32
    neighbour: I32
    beside: Flags
    around: Flags

    @classmethod
    def empty(cls, count: int) -> _Split:
        sides = np.empty((count, len(_SIDES)), np.int32)
        states = np.zeros((count, _BESIDE), np.uint8), np.zeros((count, _AROUND), np.uint8)
        return cls(np.empty(count, np.int32), np.empty(count, np.int32), sides, *states)

    @property
    def arrays(self) -> tuple[I32, I32, I32, Flags, Flags]:
        """As native code takes them."""
        return self.x, self.y, self.neighbour, self.beside, self.around


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
        nodes.beside[:, 1 + 3 * side] = nodes.beside[:, 3 + 3 * side] = there
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


class _Walk:
    """What the levels of one tree have in common."""

    def __init__(self, shape: TreeShape, scenery: Scenery, code: Callable[[Batch], tuple[Flags, Flags]]) -> None:
        self._shape, self._code, self._rates = shape, code, _Rates()
        self._detail, self._cell = scenery.detail, max(1, scenery.cell)
        self._quality, self._counts = scenery.quality, input_counts()

    def level(self, level: int, parents: _Split) -> tuple[Codes, _Split]:
        """The children of `parents`: codes of those that carry seeds, and those that are split."""
        self._rates.next_level()
        count = len(parents.x)
        exists, split, seed = (np.zeros((count + 1, 4), np.uint8) for _ in range(3))  # a last row for no parent
        for child in range(4):
            inside = 2 * parents.x + (child & 1) << level < self._shape.width
            exists[:count, child] = inside & (2 * parents.y + (child >> 1) << level < self._shape.height)
        first = 4 * morton(parents.x, parents.y)
        for turn, child in enumerate(CHILDREN):
            members = np.flatnonzero(exists[:count, child]).astype(np.int32)
            inputs = self._inputs(level, child, parents, (exists, split, seed), members)
            needed = np.full(members.size, level < LEVELS[0])
            if level < LEVELS[0]:
                needed &= ~exists[members][:, CHILDREN[turn + 1 :]].any(axis=1)
                needed &= ~(split[members] | seed[members]).any(axis=1)
            here = self._code(Batch(level, child, first[members] + child, inputs, needed))
            split[members, child], seed[members, child] = here
            self._rates.count(*here, has_split=level > LEVELS[-1])
        found = np.flatnonzero(seed)
        return first[found >> 2] + (found & 3), _children(parents, exists, split, seed)

    def _inputs(self, level: int, child: int, parents: _Split, slots: tuple[Flags, Flags, Flags], members: I32) -> I16:
        levels = [_ONE * (level == LEVELS[-1] + i) for i in range(len(LEVELS))]
        head = np.array([*levels, self._quality, *self._rates.inputs()], np.int16)
        inputs = np.empty((members.size, self._counts[child]), np.int16)
        _native.tree_inputs(parents.arrays, slots, self._detail, self._cell, head, level, child, members, inputs)
        return inputs


def _children(parents: _Split, exists: Flags, split: Flags, seed: Flags) -> _Split:
    """The children that are split."""
    found = np.flatnonzero(split).astype(np.int32)
    nodes = _Split.empty(found.size)
    number = np.empty(split.shape, np.int32)
    _native.split_children(parents.arrays, (exists, split, seed), found, number, *nodes.arrays)
    return nodes
