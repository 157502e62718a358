"""The default profile: adaptive seeds with a shipped context model, for the best quality at a size."""

from __future__ import annotations

from dataclasses import replace

from sgicodec._native import PRIOR
from sgicodec.model.spec import ContextSpec, ModelSpec
from sgicodec.profiles.fit_settings import FitSettings, Phase
from sgicodec.rate_control.quality_search import QUALITY_PER_OCTAVE

_COARSE_SPLIT = 8.0
"""`FitSettings.split` of a coarse fit, whose first layout would have five times the seeds that stay
(docs/notes/2026-11-ladder.md)."""
_SHORT_STEPS = 150
"""Coarse fits of fewer steps take half of them at a quarter of the size, for 0.3 % more bytes in nine tenths of the
time (docs/notes/2026-11-ladder.md)."""


def default_spec(channels: int, texture: bool = False) -> ModelSpec:
    """The `default` profile: adaptive seeds, log-covariances, a base layer, shipped context from decoded neighbours."""
    steps = (("colour",), ("shape",), ("offset",))
    return ModelSpec(
        channels=channels,
        layout="adaptive",
        per_seed=1,
        features=channels + 3,
        hidden=0,
        base_cell=64,
        context=ContextSpec(prior=PRIOR, steps=steps, hidden=64, neighbours=6),
        texture=texture,
    )


def default_settings(lmbda: float, steps: int, coarse: bool = False) -> FitSettings:
    """The `default` profile in `steps` steps. coarse: most of them at half size, for seeds beneath texture."""
    settings = FitSettings(lmbda=lmbda, phases=_default_phases(steps), reference_steps=800)
    return replace(settings, phases=_coarse_phases(steps), split=_COARSE_SPLIT) if coarse else settings


def _default_phases(steps: int) -> tuple[Phase, ...]:
    """A free fit at half size, noise and rate while seeds come and go, and briefly what will really be decoded.

    The last phase is short because straight-through gradients lead away from the optimum that noise found. Shares and
    numbers of prunings: docs/notes/2026-11-fit-settings.md.
    """
    free, rounded = max(1, round(0.15 * steps)), max(1, round(0.03 * steps))
    noisy = max(1, steps - free - rounded)
    return (
        Phase(free, level=1),
        Phase(noisy, rounding="noise", rate=True, learn_steps=True, prune=6, grow=4),
        Phase(rounded, rounding="round", rate=True),
    )


def _coarse_phases(steps: int) -> tuple[Phase, ...]:
    """The same with the free phase at a quarter of the size and most of the noise phase at half, or at a quarter and
    then at half, where a step takes a third or a ninth of the time.

    It suits seeds beneath texture, which are wide: those that show a few pixels want full size
    (docs/notes/2026-11-encode-speed.md; at a quarter: 2026-11-ladder.md).
    """
    free, noisy, rounded = _default_phases(steps)
    begin: tuple[Phase, ...]
    if steps >= _SHORT_STEPS:
        coarse = round(0.8 * noisy.steps)
        begin = (replace(noisy, steps=max(1, coarse), level=1, prune=5, grow=3),)
    else:
        part = int(0.45 * noisy.steps)
        coarse = 2 * part
        quarter = replace(noisy, steps=part, level=2, prune=2, grow=1)
        begin = quarter, replace(quarter, level=1, prune=3, grow=2)
    last = replace(noisy, steps=max(1, noisy.steps - coarse), prune=2, grow=0)
    return replace(free, level=2), *begin, last, rounded


def lmbda_of_quality(quality: float) -> float:
    """λ of the default profile for a quality of 1 to 100."""
    return float(0.5 * 2.0 ** (-(quality - 1) / QUALITY_PER_OCTAVE))


DEFAULT_QUALITY = 50.0
DEFAULT_LMBDA = lmbda_of_quality(DEFAULT_QUALITY)
