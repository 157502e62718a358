"""Every number that steers a fit, in one place: profiles, phases, learning rates, efforts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from sgicodec.errors import UsageError
from sgicodec.model.quantization import step_index

__all__ = [
    "EFFORTS",
    "PAPER_STEPS",
    "SLOWED",
    "FitSettings",
    "LearningRates",
    "Phase",
    "Rounding",
    "default_settings",
    "lmbda_of_quality",
    "paper_settings",
    "quality_index",
]

Rounding = Literal["none", "noise", "round"]


@dataclass(frozen=True)
class Phase:
    """A stretch of steps.

    level: pyramid level (0 is full size). rounding: exact values, uniform noise of one step, or rounded values with
    straight-through gradients. rate: whether the loss counts bits. learn_steps: whether step sizes, γ and r train.
    prune, grow: how many times, evenly spaced, seeds that do not pay are dropped, and seeds added where error stays.
    """

    steps: int
    level: int = 0
    rounding: Rounding = "none"
    rate: bool = False
    learn_steps: bool = False
    prune: int = 0
    grow: int = 0


@dataclass(frozen=True)
class LearningRates:
    """Adam's learning rates at the start; `final` is the fraction that is left at the end of a fit, `hold` how much of
    it passes before the decay begins, `decay` what its curve is, `constant` names what never decays.
    """

    colour: float = 0.028
    shape: float = 0.085
    offset: float = 0.085
    feature: float = 0.0075
    scales: float = 0.007
    decoder_colour: float = 0.008
    decoder_shape: float = 0.004
    context: float = 0.005
    steps: float = 0.03
    betas: tuple[float, float] = (0.9, 0.99)
    epsilon: float = 1e-15
    final: float = 0.01
    hold: float = 0.4
    decay: Literal["exponential", "linear"] = "linear"
    constant: tuple[str, ...] = ()

    def left(self, done: float) -> float:
        """What is left of the rates when a fraction `done` of a fit lies behind."""
        past = max(0.0, (done - self.hold) / (1 - self.hold))
        return self.final**past if self.decay == "exponential" else 1.0 - (1.0 - self.final) * past


@dataclass(frozen=True)
class FitSettings:
    """How a model is fitted.

    lmbda: squared error (samples in 0..1, summed over pixels and channels) that one bit must save; in the `paper`
    profile the λ of equation 11. loss: "squared" or "absolute". split: a cell splits while its squared deviation
    exceeds `split` seeds' worth of rate. prune: a seed is dropped when its energy is below this many times the price
    of its bits (`seed_bits`). growth: a seed is added where the squared error that its cell's mean holds is above this
    many times that price. rate_sample: share of the seeds whose bits are counted each step. seeds: their number in the
    uniform layout. seed: of every random number. reference_steps: the number of steps that the rates of `SLOWED` are
    meant for; more steps go with smaller ones. quality: index of the base colour step, where it is not to follow λ.
    """

    lmbda: float
    phases: tuple[Phase, ...]
    rates: LearningRates = field(default_factory=LearningRates)
    loss: Literal["squared", "absolute"] = "squared"
    split: float = 3.0
    prune: float = 1.0
    growth: float = 0.3
    seed_bits: float = 30.0
    rate_sample: float = 1.0
    seeds: int | None = None
    seed: int = 0
    reference_steps: int | None = None
    quality: int | None = None

    @property
    def steps(self) -> int:
        """Steps of all phases."""
        return sum(phase.steps for phase in self.phases)

    @property
    def split_price(self) -> float:
        """Squared deviation that splits a cell, for each unit of λ."""
        return self.split * self.seed_bits

    def slowing(self, steps: int) -> float:
        """Factor of the learning rates in `SLOWED` for a fit of so many steps."""
        if self.reference_steps is None:
            return 1.0
        ratio = self.reference_steps / steps
        return float(ratio**0.5 if ratio < 1 else ratio**0.25)


SLOWED = ("colour", "shape", "offset", "steps")
"""Learning rates that follow the number of steps."""


def default_settings(lmbda: float, steps: int) -> FitSettings:
    """The `default` profile in `steps` steps."""
    return FitSettings(lmbda=lmbda, phases=default_phases(steps), reference_steps=800)


def default_phases(steps: int) -> tuple[Phase, ...]:
    """A free fit at half size, noise and rate while seeds come and go, and briefly what will really be decoded.

    The last phase is short because straight-through gradients lead away from the optimum that noise found.
    """
    free, rounded = max(1, round(0.15 * steps)), max(1, round(0.03 * steps))
    noisy = max(1, steps - free - rounded)
    return (
        Phase(free, level=1),
        Phase(noisy, rounding="noise", rate=True, learn_steps=True, prune=6, grow=4),
        Phase(rounded, rounding="round", rate=True),
    )


def paper_settings(lmbda: float, levels: int, steps: int) -> FitSettings:
    """The `paper` profile: L1, the published learning rates and schedule for M = `levels`."""
    rates = LearningRates(
        offset=0.01,
        feature=0.0075,
        scales=0.007,
        decoder_colour=0.008,
        decoder_shape=0.004,
        context=0.005,
        steps=0.0,
        betas=(0.9, 0.999),
        final=0.01,
        hold=0.0,
        decay="exponential",
        constant=("feature", "scales", "decoder_shape"),
    )
    return FitSettings(
        lmbda=lmbda, phases=paper_phases(levels, steps), rates=rates, loss="absolute", rate_sample=0.05, prune=0.0
    )


def paper_phases(levels: int, steps: int) -> tuple[Phase, ...]:
    """The published schedule for M pyramid levels: noise from step 300 of each level, the rate in the last fifth."""
    parts = {1: (1.0,), 2: (0.6, 0.4), 3: (0.2, 0.4, 0.4), 4: (0.1, 0.2, 0.3, 0.4)}
    if levels not in parts:
        raise UsageError(f"levels: {levels}; the paper's schedule knows 1 to 4")
    phases: list[Phase] = []
    for index, part in enumerate(parts[levels]):
        level, count = levels - 1 - index, round(part * steps)
        free = min(count, max(1, round(300 / PAPER_STEPS * steps)))
        last = round(0.2 * steps) if level == 0 else 0
        phases += [Phase(free, level), Phase(count - free - last, level, "noise")]
        phases += [Phase(last, level, "noise", rate=True, learn_steps=True)] if last else []
    return tuple(phase for phase in phases if phase.steps > 0)


PAPER_STEPS = 15_000

EFFORTS: dict[int, int] = {1: 120, 2: 200, 3: 350, 4: 600, 5: 1000, 6: 1600, 7: 2500, 8: 4000, 9: 8000}
"""Optimisation steps of the default profile for each effort."""


def lmbda_of_quality(quality: float) -> float:
    """λ of the default profile for a quality of 1 to 100: 16 steps of quality halve it twice."""
    return float(0.5 * 2.0 ** (-(quality - 1) / 8.0))


def quality_index(lmbda: float) -> int:
    """Index of the colour step that rate theory gives cells of 8 pixels: q² = 6 λ / (E ln 2), with E the squared error
    of a unit of colour in a Gaussian of about half the cell's size.
    """
    return int(step_index(math.sqrt(6 * max(lmbda, 1e-12) / (math.log(2) * math.pi * 0.3 * 64))))
