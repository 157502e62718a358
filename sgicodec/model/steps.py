"""Base steps of every attribute and cell size, and how amplitude and MLP_p refine them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sgicodec._native import GAMMA_BITS
from sgicodec.arrays import I64
from sgicodec.model.context import LEVELS, output_count
from sgicodec.model.quantization import STEP_COUNT, STEP_ZERO, step_index
from sgicodec.model.spec import ModelSpec

__all__ = [
    "GAMMA_BITS",
    "StepPlan",
    "colour_step_of",
    "default_plan",
    "follows_amplitude",
]


# Steps relative to the colour step of the same cell, sixths of an octave, at amplitude 2^(-20/6).
_SHAPE_OVER_COLOUR = 26
_PAPER_STEPS = {"feature": STEP_ZERO, "scales": STEP_ZERO, "offset": STEP_ZERO - 14}


@dataclass(frozen=True)
class StepPlan:
    """base: for each group, indices [U, LEVELS] of the base step of each of MLP_p's outputs and cell sizes;
    gamma: for each group, the exponent γ of the amplitude in sixteenths.
    """

    base: dict[str, I64]
    gamma: dict[str, int]


def follows_amplitude(spec: ModelSpec, group: str) -> bool:
    """Whether a group's steps follow the amplitude: its colours are known by then."""
    return spec.plain and group != "colour"


def default_plan(spec: ModelSpec, colour_step: int) -> StepPlan:
    """The plan that rate theory gives for this index of the colour step, in cells of 8 pixels.

    The distortion of a step grows with the area that a Gaussian covers, so steps halve when cells double. The stream
    carries differences to this plan.
    """
    base = {}
    for group in spec.groups:
        if spec.plain:
            over = 0 if group.name == "colour" else _SHAPE_OVER_COLOUR
            index = colour_step + over - 6 * (np.arange(LEVELS) - 3)
        else:
            index = np.full(LEVELS, _PAPER_STEPS[group.name])
        shape = (output_count(spec, group.name), LEVELS)
        base[group.name] = np.broadcast_to(np.clip(index, 0, STEP_COUNT - 1), shape).astype(np.int64)
    gamma = {group.name: 16 if follows_amplitude(spec, group.name) else 0 for group in spec.groups}
    return StepPlan(base, gamma)


def colour_step_of(lmbda: float) -> int:
    """Index of the colour step that rate theory gives cells of 8 pixels: q² = 6 λ / (E ln 2), with E the squared error
    of a unit of colour in a Gaussian of about half the cell's size.
    """
    return int(step_index(math.sqrt(6 * max(lmbda, 1e-12) / (math.log(2) * math.pi * 0.3 * 64))))
