"""Step sizes as they train: one flat array of floats, which rounds to the `StepPlan` of a stream."""

from __future__ import annotations

import numpy as np

from sgicodec.arrays import F32
from sgicodec.model.context import LEVELS, output_count
from sgicodec.model.quantization import PER_OCTAVE, STEP_COUNT, STEP_ZERO
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import GAMMA_BITS, StepPlan, follows_amplitude


def base_counts(spec: ModelSpec) -> list[int]:
    """How many base steps each group has: one for each of MLP_p's outputs and cell sizes."""
    return [output_count(spec, group.name) * LEVELS for group in spec.groups]


def gamma_names(spec: ModelSpec) -> list[str]:
    """The groups whose steps follow the amplitude."""
    return [group.name for group in spec.groups if follows_amplitude(spec, group.name)]


def flat_steps(spec: ModelSpec, plan: StepPlan) -> F32:
    """log2 of all base steps by group, output and cell size, then γ of the groups that follow the amplitude."""
    base = [(plan.base[group.name].reshape(-1) - STEP_ZERO) / PER_OCTAVE for group in spec.groups]
    gamma = [plan.gamma[name] / 2.0**GAMMA_BITS for name in gamma_names(spec)]
    return np.concatenate([*base, np.array(gamma)]).astype(np.float32)


def rounded_plan(spec: ModelSpec, steps: F32) -> StepPlan:
    """The steps in the stream's units."""
    counts, names = base_counts(spec), gamma_names(spec)
    parts = np.split(np.rint(steps[: sum(counts)] * PER_OCTAVE) + STEP_ZERO, np.cumsum(counts)[:-1])
    base = {
        group.name: np.clip(part, 0, STEP_COUNT - 1).astype(np.int64).reshape(-1, LEVELS)
        for group, part in zip(spec.groups, parts, strict=True)
    }
    rounded = np.clip(np.rint(steps[sum(counts) :].astype(np.float64) * 2**GAMMA_BITS), 0, 63).astype(np.int64)
    gamma = dict(zip(names, rounded.tolist(), strict=True))
    return StepPlan(base, {name: gamma.get(name, 0) for name in base})
