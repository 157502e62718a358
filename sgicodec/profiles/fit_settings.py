"""How a model is fitted: phases, learning rates, prices. Each profile has its own values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

Rounding = Literal["none", "noise", "round"]


@dataclass(frozen=True)
class Phase:
    """A stretch of steps."""

    steps: int
    """Optimisation steps."""
    level: int = 0
    """Of the pyramid, 0 for full size."""
    rounding: Rounding = "none"
    """Exact values, uniform noise of one step, or rounded values with straight-through gradients."""
    rate: bool = False
    """Whether the loss counts bits."""
    learn_steps: bool = False
    """Whether step sizes, γ and r train."""
    prune: int = 0
    """How many times, evenly spaced, seeds that do not pay are dropped."""
    grow: int = 0
    """How many times, evenly spaced, seeds are added where error stays."""


@dataclass(frozen=True)
class LearningRates:
    """Adam's learning rates at the start of a fit, in units of what they train, and how they decay.

    Defaults were measured: docs/notes/2026-11-fit-settings.md, 2026-11-optimiser.md.
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
    """Of base steps, γ and r, in octaves."""
    betas: tuple[float, float] = (0.9, 0.99)
    """Adam's β of both moments."""
    epsilon: float = 1e-15
    """Adam's ε."""
    final: float = 0.01
    """Share of a rate that is left at the end of a fit."""
    hold: float = 0.4
    """Share of a fit that passes before the decay begins."""
    decay: Literal["exponential", "linear"] = "linear"
    """Its curve."""
    finals: Mapping[str, float] = field(default_factory=dict)
    """`final` of the rates that it names."""

    def left(self, name: str, done: float) -> float:
        """What is left of a rate when a fraction `done` of a fit lies behind."""
        final = self.finals.get(name, self.final)
        past = max(0.0, (done - self.hold) / (1 - self.hold))
        return final**past if self.decay == "exponential" else 1.0 - (1.0 - final) * past


@dataclass(frozen=True)
class FitSettings:
    """How a model is fitted. Defaults were measured: docs/notes/2026-11-fit-settings.md."""

    lmbda: float
    """Squared error, samples in 0..1 summed over pixels and channels, that one bit must save; in the `paper` profile
    the λ of equation 11."""
    phases: tuple[Phase, ...]
    """In their order."""
    rates: LearningRates = field(default_factory=LearningRates)
    """Learning rates."""
    split: float = 3.0
    """A cell of the first layout splits while its squared deviation exceeds so many seeds' worth of rate."""
    prune: float = 1.0
    """A seed is dropped when its energy is below so many times the price of its bits."""
    growth: float = 0.3
    """A seed is added where the squared error that its cell's mean holds is above so many times that price."""
    seed_bits: float = 30.0
    """Bits of a seed in these prices."""
    rate_sample: float = 1.0
    """Share of the seeds whose bits are counted in each step."""
    seeds: int | None = None
    """Their number in the uniform layout; None for one per 400 pixels."""
    seed: int = 0
    """Of every random number."""
    reference_steps: int | None = None
    """Number of steps that the rates of `SLOWED` are meant for; more steps go with smaller ones. None: they stay."""
    finer_steps: float = 0.0
    """Octaves by which base steps are below the profile's plan."""
    colour_step: int | None = None
    """Index of the base colour step, None where it follows λ."""

    @property
    def steps(self) -> int:
        """Steps of all phases."""
        return sum(phase.steps for phase in self.phases)

    def shortened(self, part: float) -> FitSettings:
        """The same with a part of the steps of each phase, at least one."""
        return replace(self, phases=tuple(replace(p, steps=max(1, round(part * p.steps))) for p in self.phases))

    def slowing(self) -> float:
        """Factor of the learning rates in `SLOWED` for a fit of so many steps."""
        if self.reference_steps is None:
            return 1.0
        ratio = self.reference_steps / self.steps
        return float(ratio**0.5 if ratio < 1 else ratio**0.25)


SLOWED = ("colour", "shape", "offset", "steps")
"""Learning rates that follow the number of steps."""
