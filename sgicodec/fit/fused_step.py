"""A step of the default profile in native code: loss and gradients without automatic differentiation."""

from __future__ import annotations

from enum import Enum

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.device import Device
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.parameters import Parameters, StepResult
from sgicodec.fit.pyramid import Level
from sgicodec.model.context import neighbour_table
from sgicodec.model.gaussians import MIN_VARIANCE, colour_matrix, empty_gaussians
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import Rounding
from sgicodec.raster.backend import Backend

__all__ = ["REFRESH", "ROUNDINGS", "FusedStep", "Reuse", "reuse_of"]

F32 = NDArray[np.float32]

ROUNDINGS: dict[Rounding, int] = {"none": 0, "noise": 1, "round": 2}
_GROUPS = ("colour", "shape", "offset")
_FLOOR = np.array([MIN_VARIANCE, 0.0, MIN_VARIANCE], np.float32)

REFRESH, PREDICT = 8, 4
"""How many steps inputs from neighbours stand, and predictions under noise where only MLP_p's difference trains
(docs/notes/2026-11-fit-settings.md)."""


class Reuse(Enum):
    """What a step takes over from those before it: nothing, inputs from neighbours, or all that MLP_p predicts."""

    NOTHING, INPUTS, PREDICTIONS = range(3)


def reuse_of(age: int, rounding: Rounding, context: ContextWeights) -> Reuse:
    """What the step takes over, `age` steps after inputs from neighbours were found."""
    if age == 0 or rounding == "none":
        return Reuse.NOTHING
    lazy = rounding == "noise" and context.difference is not None and age % PREDICT
    return Reuse.PREDICTIONS if lazy else Reuse.INPUTS


class FusedStep:
    """A `GradientStep` for squared error and Laplacian bits, for the models that `can_run` names.

    Noise is a hash of (its key, column, seed), so that a step does not depend on the number of threads. Inputs from
    neighbours are found again every `REFRESH` steps: they move slowly, and all seeds can then be evaluated at once
    although coding visits them pass by pass. Under noise, where MLP_p is a prior's and only its difference trains, it
    runs every `PREDICT` steps: in between, its last outputs and the gradients of its difference and of the steps stand.
    """

    def __init__(self, spec: ModelSpec, seed: int, raster: Backend[F32], device: Device) -> None:
        opponent = np.array(colour_matrix(spec.channels), np.float32)
        self.native = _native.SeedFit(device.isa, device.threads, spec.context.hidden, opponent)
        self.spec, self.seed, self.raster = spec, seed, raster
        self.age = 0
        self.standing: dict[str, F32] = {}

    @staticmethod
    def can_run(spec: ModelSpec) -> bool:
        """Whether the native code has this model: the default profile's, with any C and width of MLP_p."""
        return spec.plain and 0 < spec.context.neighbours <= _native.MAX_NEIGHBOURS

    def set_layout(self, layout: SeedLayout, quality: int) -> None:
        """Prepares everything that depends on where the seeds are."""
        neighbour = neighbour_table(self.spec.context, layout)
        self.native.set_layout(layout.half_pixels, layout.log_size, neighbour, quality)
        self.count = len(layout)
        self.age = 0

    def run(self, parameters: Parameters, rounding: Rounding, number: int, level: Level, lmbda: float) -> StepResult:
        """As `GradientStep.run`."""
        colour, shape, offset = values = [parameters.seeds.values[name] for name in _GROUPS]
        context, noise = parameters.context, NoiseKey.of(self.seed, number)
        gaussians = empty_gaussians(self.count, self.spec.channels)
        reuse = reuse_of(self.age, rounding, context)
        rest = context.effective_rest()  # the backward pass reads it again
        bits = self.native.forward(
            colour,
            shape,
            offset,
            context.first,
            rest,
            parameters.steps,
            ROUNDINGS[rounding],
            noise.key,
            noise.negative,
            reuse.value,
            context.trains,
            *gaussians,
        )
        self.age = (self.age + 1) % REFRESH if rounding != "none" else 0
        error, slopes = self._draw(gaussians, level)
        d_colour, d_shape, d_offset = (np.empty_like(value) for value in values)
        sums = np.empty(self.native.sums, np.float32)
        self.native.backward(*slopes, lmbda, d_colour, d_shape, d_offset, sums)
        gradients = {"colour": d_colour, "shape": d_shape, "offset": d_offset}
        if rounding != "none":
            if reuse is not Reuse.PREDICTIONS:
                self.standing = self._shared_gradients(sums, len(parameters.steps), context, lmbda)
            gradients |= self.standing
        return StepResult(error, bits, gradients)

    @staticmethod
    def _shared_gradients(sums: F32, steps: int, context: ContextWeights, lmbda: float) -> dict[str, F32]:
        """Those of what all seeds share, from sums over seeds: of b1, W2 and b2, then steps, then W1 if it trains."""
        at = len(context.rest)
        rest, gradients = sums[:at], {"steps": sums[at : at + steps]}
        if context.difference is not None:
            gradients["context.difference"] = rest + context.difference_gradient(lmbda) if lmbda else rest
        elif context.trains:
            gradients |= {"context.first": sums[at + steps :], "context.rest": rest}
        return gradients

    def _draw(self, gaussians: tuple[F32, F32, F32], level: Level) -> tuple[float, tuple[F32, F32, F32]]:
        """Squared error without weights, and the gradients of that with weights in the Gaussians at full size."""
        (means, covariances, colours), scale = gaussians, level.scale
        if scale != 1.0:
            # Only the cells shrink with a level; MIN_VARIANCE stays a matter of the pixels that are rendered.
            less = np.float32(scale * scale)
            means, covariances = means * np.float32(scale), covariances * less + _FLOOR * (1 - less)
        drawn = means, covariances, colours, level.samples
        (_, error), (d_means, d_covariances, d_colours) = self.raster.error(*drawn, weights=level.weights)
        if scale != 1.0:
            d_means, d_covariances = d_means * np.float32(scale), d_covariances * np.float32(scale * scale)
        return error, (d_means, d_covariances, d_colours)
