"""What the context model MLP_p sees and says of each seed: counts, passes, and the inputs that a layout gives."""

from __future__ import annotations

import numpy as np

from sgicodec._native import (
    INPUT_BITS,
    LEVELS,
    NEIGHBOUR_INPUTS,
    HashGrid,
    neighbours_by_pass,
    own_input_count,
)
from sgicodec.arrays import I32, I64
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ContextSpec, ModelSpec

__all__ = [
    "INPUT_BITS",
    "LEVELS",
    "hash_grid",
    "input_count",
    "level_inputs",
    "nearest_by_pass",
    "neighbour_table",
    "network_shapes",
    "output_count",
]


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


def level_inputs(layout: SeedLayout, colour_step: int) -> I64:
    """One-hot cell size and the base colour step (sixths of an octave) [N, LEVELS + 1]."""
    one_hot = np.zeros((len(layout), LEVELS + 1), np.int64)
    one_hot[np.arange(len(layout)), np.clip(layout.log_size, 0, LEVELS - 1)] = 1 << INPUT_BITS
    one_hot[:, LEVELS] = colour_step * (1 << INPUT_BITS) // 12
    return one_hot


def input_count(spec: ModelSpec, step: int) -> int:
    """Inputs of MLP_p at a step of `ContextSpec.steps`."""
    context = spec.context
    count = LEVELS + 1 + len(context.hash_resolutions) * context.hash_features
    if context.neighbours:
        count += NEIGHBOUR_INPUTS
    return count + own_input_count(step)


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


def hash_grid(spec: ContextSpec, width: int, height: int) -> HashGrid:
    """The binary hash grid H of a picture: `hash_resolutions` cells across its longer side."""
    return HashGrid([*spec.hash_resolutions], spec.hash_features, spec.hash_log2_entries, width, height)
