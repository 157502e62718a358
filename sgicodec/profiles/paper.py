"""The paper profile: the method as the paper describes it."""

from __future__ import annotations

from collections.abc import Mapping

from sgicodec.errors import UsageError
from sgicodec.model.spec import ContextSpec, ModelSpec
from sgicodec.profiles.fit_settings import FitSettings, LearningRates, Phase

PAPER_STEPS = 15_000
"""Of the published schedule."""

_MAX_FREE = 0.35
"""Of a level's steps, how many are without noise where the fit is shorter than the published one
(docs/notes/2026-11-paper-profile.md)."""

_RATE_SHARE = 0.4
"""Of all steps, in which bits count; a fifth as published. Steps become finer then, and PSNR rises to the end: 0.2 dB
more in 3 % fewer bytes (docs/notes/2026-11-paper-profile.md)."""

_MAX_CONTEXT = 0.08
"""MLP_p and the hash grid learn while bits count; the learning rates of shorter fits sum to as much, up to this one
(docs/notes/2026-11-paper-profile.md)."""

_EXACT_STEPS = 6.0
"""Octaves by which base steps are below the published ones where bits have no price (λ = 0)."""

_FINALS = {"offset": 0.1, "decoder_colour": 0.079, "context": 0.045}
"""What is left of the rates that decay: the published curves end at 1 % or less after 30,000 steps, fits at 15,000
(docs/notes/2026-11-paper-profile.md)."""

_PARTS = {
    "x_a": ("positions",),
    "f_a": ("feature",),
    "{s_o, s_a}": ("scales",),
    "δ": ("offset",),
    "H": ("hash grid",),
    "MLPs": ("decoders", "context model"),
}
"""Of a stream, as the paper has them."""


def paper_spec(channels: int, per_seed: int = 10, features: int = 50) -> ModelSpec:
    """The `paper` profile: uniform seeds, rotations, plain MLPs, a binary hash grid of 12 levels as context."""
    return ModelSpec(
        channels=channels,
        layout="uniform",
        per_seed=per_seed,
        features=features,
        hidden=features,
        base_cell=0,
        context=ContextSpec(
            prior=0,
            steps=(("feature", "scales", "offset"),),
            hidden=2 * features,
            hash_resolutions=(18, 24, 33, 44, 59, 80, 108, 148, 201, 275, 376, 514),
        ),
    )


def paper_settings(lmbda: float, levels: int, steps: int) -> FitSettings:
    """The `paper` profile: L1, the published learning rates and schedule for M = `levels`."""
    rates = LearningRates(
        offset=0.01,
        feature=0.0075,
        scales=0.007,
        decoder_colour=0.008,
        decoder_shape=0.004,
        context=min(0.005 * PAPER_STEPS / steps, _MAX_CONTEXT),
        steps=0.0,
        betas=(0.9, 0.999),
        final=1.0,
        finals=_FINALS,
        hold=0.0,
        decay="exponential",
    )
    phases = _paper_phases(levels, steps, lmbda > 0)
    finer = 0.0 if lmbda else _EXACT_STEPS
    return FitSettings(lmbda, phases, rates, rate_sample=0.05, prune=0.0, finer_steps=finer)


def _paper_phases(levels: int, steps: int, priced: bool = True) -> tuple[Phase, ...]:
    """The published schedule for M pyramid levels: each begins without noise; bits count in the last `_RATE_SHARE`.

    Without noise are a tenth of the published length of a level (300, 600 and 600 steps for M = 3), in a shorter fit
    as many steps, but at most `_MAX_FREE` of the level: features cannot leave the noise before they are as large.
    Where bits have no price there is no noise at all.
    """
    parts = {1: (1.0,), 2: (0.6, 0.4), 3: (0.2, 0.4, 0.4), 4: (0.1, 0.2, 0.3, 0.4)}
    if levels not in parts:
        raise UsageError(f"levels: {levels}; the paper's schedule knows 1 to 4")
    phases: list[Phase] = []
    for index, part in enumerate(parts[levels]):
        level, count = levels - 1 - index, round(part * steps)
        free = round(min(0.1 * part * PAPER_STEPS, _MAX_FREE * part * steps)) if priced else count
        free = min(count, max(1, free))
        last = min(count - free, round(_RATE_SHARE * steps)) if level == 0 else 0
        phases += [Phase(free, level), Phase(count - free - last, level, "noise")]
        phases += [Phase(last, level, "noise", rate=True, learn_steps=True)]
    return tuple(phase for phase in phases if phase.steps > 0) or (Phase(steps),)  # too few to share out


def paper_parts(parts: Mapping[str, float]) -> dict[str, float]:
    """Bytes of the parts of a stream under the paper's names; parts without one keep their own."""
    table = {name: sum(parts.get(part, 0.0) for part in members) for name, members in _PARTS.items()}
    known = {part for members in _PARTS.values() for part in members}
    return table | {name: size for name, size in parts.items() if name not in known}
