"""What the context model MLP_p sees and says of each seed: counts, passes, and the inputs that a layout gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import INPUT_BITS, LEVELS, NEIGHBOUR_INPUTS, SUMMARY, neighbours_by_pass, own_input_count
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ContextSpec, ModelSpec

__all__ = [
    "INPUT_BITS",
    "LEVELS",
    "SUMMARY",
    "HashGrid",
    "input_count",
    "level_inputs",
    "nearest_by_pass",
    "neighbour_table",
    "network_shapes",
    "output_columns",
    "output_count",
]

I32 = NDArray[np.int32]
I64 = NDArray[np.int64]


def nearest_by_pass(spec: ContextSpec, layout: SeedLayout) -> list[tuple[I64, I32]]:
    """The seeds that each pass codes [n], and indices [n, k] of their nearest seeds of earlier passes: nearest first,
    −1 where there is none.
    """
    return neighbours_by_pass(spec.neighbours, layout.corner, layout.log_size)


def neighbour_table(spec: ContextSpec, layout: SeedLayout) -> I32:
    """Indices [N, k] of each seed's nearest seeds of earlier passes, nearest first; −1 where there is none."""
    table = np.full((len(layout), spec.neighbours), -1, np.int32)
    for members, found in nearest_by_pass(spec, layout):
        table[members] = found
    return table


def level_inputs(layout: SeedLayout, quality: int) -> I64:
    """One-hot cell size and the picture's quality (base colour step, sixths of an octave) [N, LEVELS + 1]."""
    one_hot = np.zeros((len(layout), LEVELS + 1), np.int64)
    one_hot[np.arange(len(layout)), np.clip(layout.log_size, 0, LEVELS - 1)] = 1 << INPUT_BITS
    one_hot[:, LEVELS] = quality * (1 << INPUT_BITS) // 12
    return one_hot


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
    if not spec.plain:
        return np.arange(size)
    if group == "colour":
        channel = np.arange(size)
        return np.where((channel < 3) & (spec.channels >= 3), channel, 0)
    return np.arange(size)


def output_count(spec: ModelSpec, group: str) -> int:
    """Distinct predictions of a group: a mean and a scale each."""
    if not spec.plain:
        return spec.group(group).size
    return {"colour": 3, "shape": 3, "offset": 2}.get(group, spec.group(group).size)


def network_shapes(spec: ModelSpec, step: int) -> dict[str, tuple[int, ...]]:
    """Shapes of MLP_p's weights at a step of `ContextSpec.steps`."""
    names = spec.context.steps[step]
    inputs, hidden = input_count(spec, step), spec.context.hidden
    outputs = 2 * sum(output_count(spec, name) for name in names) + len(names)
    return {"w1": (hidden, inputs), "b1": (hidden,), "w2": (outputs, hidden), "b2": (outputs,)}


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
