"""Everything that trains in a fit, and what a step says of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from sgicodec.arrays import F32
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.pyramid import PyramidLevel
from sgicodec.fit.seed_set import SeedSet
from sgicodec.model.layout import SeedLayout
from sgicodec.profiles.fit_settings import Rounding


@dataclass
class Parameters:
    """seeds: attributes and decoders; steps: as `step_sizes.flat_steps`; context: MLP_p and the hash grid, None where
    MLP_p is shipped.
    """

    seeds: SeedSet
    steps: F32
    context: ContextWeights | None

    def trained(self) -> dict[str, F32]:
        """The arrays that train, by name."""
        networks = self.seeds.by_network(self.seeds.decoder_weights)
        decoders = {f"decoder_{name}": weights for name, weights in networks.items()}
        context = self.context.trained() if self.context is not None else {}
        return {**self.seeds.values, **decoders, "steps": self.steps, **context}


def learning_rate_of(name: str) -> str:
    """The field of `LearningRates` that an array's name belongs to."""
    return name.partition(".")[0]


@dataclass(frozen=True)
class StepResult:
    """error: squared, without weights, samples in 0..1, summed over pixels and channels; bits: of all seeds'
    attributes; gradients: of the loss, which has weights, in the arrays that take part, by their names in
    `Parameters.trained`.
    """

    error: float
    bits: float
    gradients: dict[str, F32]


class GradientStep(Protocol):
    """What computes the loss of a fit and its gradients."""

    def set_layout(self, layout: SeedLayout, colour_step: int) -> None:
        """Prepares everything that depends on where the seeds are."""
        ...

    def run(
        self, parameters: Parameters, rounding: Rounding, number: int, level: PyramidLevel, lmbda: float
    ) -> StepResult:
        """Step `number` of a fit against a level of the pyramid. λ 0: bits do not count."""
        ...
