"""The inputs of the context model MLP_p for each seed, in the fixed point of encoder and decoder.

Inputs are integers in units of 2^-6 when coding and floats in the same units when training; the functions here take
either, with `floor_shift(x, k)` standing for x >> k or x / 2^k. A seed's decoded values enter as a *summary*: three
opponent colours and three shape numbers, so that one network serves any C.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import (
    INPUT_BITS,
    LEVELS,
    NEIGHBOUR_INPUTS,
    OFFSET_LIMIT,
    SUMMARY,
    neighbour_weight,
    own_input_count,
)
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ContextSpec, ModelSpec

__all__ = [
    "INPUT_BITS",
    "LEVELS",
    "SUMMARY",
    "HashGrid",
    "hash_inputs",
    "input_count",
    "level_inputs",
    "nearest_by_pass",
    "nearest_offset",
    "neighbour_inputs",
    "neighbour_table",
    "output_columns",
    "output_count",
    "own_inputs",
    "passes",
]

COARSEST = 5
"""log2 of the cells that are coded first; larger ones go with them."""

I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
Nearest = Callable[[I32, I64, I64, int], I32]
"""As `neighbours.nearest_seeds`."""


def passes(spec: ContextSpec, layout: SeedLayout) -> list[I64]:
    """Indices of the seeds that each pass codes: all at once without neighbours, else the four parities of the cells
    of each size, from 2^COARSEST pixels (and above) down to 2 (and below), so that the first draw a coarse picture.
    """
    if not spec.neighbours:
        return [np.arange(len(layout))]
    number = layout.parity + 4 * (COARSEST - np.clip(layout.log_size.astype(np.int64), 1, COARSEST))
    order, bounds = np.argsort(number.astype(np.int16), kind="stable"), np.cumsum(np.bincount(number))
    return [members for members in np.split(order, bounds) if len(members)]


def nearest_by_pass(spec: ContextSpec, layout: SeedLayout, nearest: Nearest) -> Iterator[tuple[I64, I32]]:
    """The seeds of each pass [n], and indices [n, k] of their nearest seeds of earlier passes: nearest first, −1 where
    there is none.
    """
    points = layout.half_pixels
    seen = np.zeros(len(layout), bool)
    for members in passes(spec, layout):
        table = np.full((len(members), spec.neighbours), -1, np.int32)
        earlier = np.flatnonzero(seen)
        if spec.neighbours and len(earlier) and len(members):
            table = nearest(points, earlier, members, spec.neighbours)
        yield members, table
        seen[members] = True


def neighbour_table(spec: ContextSpec, layout: SeedLayout, nearest: Nearest) -> tuple[I64, I64]:
    """Indices [N, k] of each seed's nearest seeds of earlier passes (0 where there is none) and whether they exist."""
    table = np.full((len(layout), spec.neighbours), -1, np.int64)
    for members, found in nearest_by_pass(spec, layout, nearest):
        table[members] = found
    return np.maximum(table, 0), (table >= 0).astype(np.int64)


def level_inputs(layout: SeedLayout, quality: int) -> I64:
    """One-hot cell size and the picture's quality (base colour step, sixths of an octave) [N, LEVELS + 1]."""
    one_hot = np.zeros((len(layout), LEVELS + 1), np.int64)
    one_hot[np.arange(len(layout)), np.clip(layout.log_size, 0, LEVELS - 1)] = 1 << INPUT_BITS
    one_hot[:, LEVELS] = quality * (1 << INPUT_BITS) // 12
    return one_hot


def neighbour_inputs(
    summary: Any, table: Any, present: Any, log_size: Any, offset: Any, stack: Any, floor_shift: Any
) -> Any:
    """Inputs of n seeds from their neighbours [n, NEIGHBOUR_INPUTS].

    summary [N, SUMMARY] of decoded seeds; table, present [n, k]; log_size: cell sizes [N] and those of the n seeds as
    a pair; offset [n, 2] from each seed to its nearest neighbour in its own cells, input units.
    """
    own_size, all_sizes = log_size
    one = 1 << INPUT_BITS
    weighted: Any = 0
    weighted_abs: Any = 0
    level: Any = 0
    count: Any = 0
    for rank in range(table.shape[1]):
        rows = summary[table[:, rank]]
        seen = present[:, rank : rank + 1]
        weight = neighbour_weight(rank)
        weighted = weighted + rows * (seen * weight)
        weighted_abs = weighted_abs + abs(rows[:, [0, 1, 2, 5, 6]]) * (seen * weight)
        level = level + (all_sizes[table[:, rank]] - own_size)[:, None] * (seen * (weight * one))
        count = count + seen * (weight * one)
    nearest = summary[table[:, 0]] * present[:, :1]
    blocks = [
        floor_shift(count, 4),
        floor_shift(weighted, 4),
        floor_shift(weighted_abs, 4),
        floor_shift(level, 4),
    ]
    return stack([*blocks, nearest, offset * present[:, :1]], -1)


def own_inputs(summary: Any, step: int, stack: Any) -> Any:
    """What a seed's own earlier groups say [n, 7 or 12]: colours, their size and, after the shape, the shape."""
    colours = summary[:, :3]
    columns = [colours, abs(colours), summary[:, 3:4]]
    if step >= 2:
        columns += [summary[:, 4:7], abs(summary[:, 5:7])]
    return stack(columns, -1)


def nearest_offset(layout: SeedLayout, table: I64) -> I64:
    """From each seed to its nearest neighbour, in its own cells, input units, at most OFFSET_LIMIT cells [N, 2]."""
    points = layout.half_pixels.astype(np.int64)
    difference = points[table[:, 0]] - points
    scaled = (difference << INPUT_BITS) >> (layout.log_size.astype(np.int64) + 1)[:, None]
    clipped: I64 = np.clip(scaled, -OFFSET_LIMIT << INPUT_BITS, OFFSET_LIMIT << INPUT_BITS)
    return clipped


def input_count(spec: ModelSpec, step: int) -> int:
    """Inputs of MLP_p at a step of `ContextSpec.steps`."""
    context = spec.context
    count = LEVELS + 1 + len(context.hash_resolutions) * context.hash_features
    if context.neighbours:
        count += NEIGHBOUR_INPUTS
    return count + own_input_count(step)


def output_columns(spec: ModelSpec, group: str) -> NDArray[np.int64]:
    """Which of MLP_p's outputs of its kind predicts each attribute of a group [size].

    With the skip, channels beyond three, and those of pictures with fewer than three, share luma's.
    """
    size = spec.group(group).size
    if not spec.skip:
        return np.arange(size)
    if group == "colour":
        channel = np.arange(size)
        return np.where((channel < 3) & (spec.channels >= 3), channel, 0)
    return np.arange(size)


def output_count(spec: ModelSpec, group: str) -> int:
    """Distinct predictions of a group: a mean and a scale each."""
    if not spec.skip:
        return spec.group(group).size
    return {"colour": 3, "shape": 3, "offset": 2}.get(group, spec.group(group).size)


@dataclass(frozen=True)
class HashGrid:
    """Where seeds read the binary hash grid H: entries and dyadic bilinear weights of every resolution.

    entry [L, N, 4] indices into that level's table, weight [L, N, 4] in units of 2^-12 (they sum to 4096), sizes [L].
    """

    entry: I64
    weight: I64
    sizes: tuple[int, ...]

    @classmethod
    def at(cls, spec: ContextSpec, layout: SeedLayout, width: int, height: int) -> HashGrid:
        """The grid at a layout's seeds: `hash_resolutions` cells across the longer side of the picture."""
        points = layout.half_pixels.astype(np.int64)
        longer = 2 * max(width, height)
        entries, weights, sizes = [], [], []
        for resolution in spec.hash_resolutions:
            position = points * (resolution << 6) // longer
            cell, fraction = position >> 6, position & 63
            across = resolution + 1
            rows = across * (2 * height) // longer + 2
            dense = across * rows
            size = min(dense, 1 << spec.hash_log2_entries)
            corner_entries, corner_weights = [], []
            for dy in (0, 1):
                for dx in (0, 1):
                    x, y = cell[:, 0] + dx, cell[:, 1] + dy
                    index = y * across + x if dense <= size else x ^ (y * 2654435761)
                    corner_entries.append(index % size)
                    wx = fraction[:, 0] if dx else 64 - fraction[:, 0]
                    corner_weights.append(wx * (fraction[:, 1] if dy else 64 - fraction[:, 1]))
            entries.append(np.stack(corner_entries, axis=1))
            weights.append(np.stack(corner_weights, axis=1))
            sizes.append(size)
        return cls(np.stack(entries), np.stack(weights), tuple(sizes))


def hash_inputs(grid: HashGrid, rows: Any, tables: list[Any], weight: Any, stack: Any, floor_shift: Any) -> Any:
    """H(x_a) of the seeds `rows` by bilinear interpolation of ±1 features [n, L·F] (paper, equation 9)."""
    columns = []
    for level, table in enumerate(tables):
        corners = table[grid.entry[level][rows]]  # [n, 4, F]
        mixed = (corners * weight[level][rows][:, :, None]).sum(1)
        columns.append(floor_shift(mixed, 12 - INPUT_BITS))
    return stack(columns, -1)
