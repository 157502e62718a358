"""How a model is fitted: phases, learning rates, prices. Each profile has its own values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

__all__ = ["SLOWED", "FitSettings", "LearningRates", "Phase", "Rounding"]

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
    """Adam's learning rates at the start; `final` is the share that is left at the end of a fit, `finals` that of the
    rates that it names, `hold` how much of a fit passes before the decay begins, `decay` what its curve is.
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
    finals: Mapping[str, float] = field(default_factory=dict)

    def left(self, name: str, done: float) -> float:
        """What is left of a rate when a fraction `done` of a fit lies behind."""
        final = self.finals.get(name, self.final)
        past = max(0.0, (done - self.hold) / (1 - self.hold))
        return final**past if self.decay == "exponential" else 1.0 - (1.0 - final) * past


@dataclass(frozen=True)
class FitSettings:
    """How a model is fitted.

    lmbda: squared error (samples in 0..1, summed over pixels and channels) that one bit must save; in the `paper`
    profile the λ of equation 11. loss: "squared" or "absolute". split: a cell splits while its squared deviation
    exceeds `split` seeds' worth of rate. prune: a seed is dropped when its energy is below this many times the price
    of its bits (`seed_bits`). growth: a seed is added where the squared error that its cell's mean holds is above this
    many times that price. rate_sample: share of the seeds whose bits are counted each step. seeds: their number in the
    uniform layout. seed: of every random number. reference_steps: the number of steps that the rates of `SLOWED` are
    meant for; more steps go with smaller ones. finer_steps: octaves by which base steps are below the profile's plan.
    quality: index of the base colour step, where it is not to follow λ.
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
    finer_steps: float = 0.0
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
        """Factor of the learning rates in `SLOWED` for a fit of `steps` steps."""
        if self.reference_steps is None:
            return 1.0
        ratio = self.reference_steps / steps
        return float(ratio**0.5 if ratio < 1 else ratio**0.25)


SLOWED = ("colour", "shape", "offset", "steps")
"""Learning rates that follow the number of steps."""
