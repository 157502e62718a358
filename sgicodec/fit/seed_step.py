"""A step of the default profile in native code: loss and gradients without automatic differentiation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sgicodec import _native
from sgicodec.arrays import F32
from sgicodec.device import Device
from sgicodec.fit.context_weights import float_weights
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.parameters import Parameters, StepResult
from sgicodec.fit.pyramid import PyramidLevel
from sgicodec.model.context import neighbour_table
from sgicodec.model.gaussians import MIN_VARIANCE, empty_gaussians
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import Rounding
from sgicodec.raster.backend import Backend

ROUNDINGS: dict[Rounding, int] = {"none": 0, "noise": 1, "round": 2}
_GROUPS = ("colour", "shape", "offset")
_FLOOR = np.array([MIN_VARIANCE, 0.0, MIN_VARIANCE], np.float32)

REFRESH = 8
"""How many steps stand what neighbours tell and what MLP_p predicts (docs/notes/2026-11-fit-settings.md)."""


class SeedStep:
    """A `GradientStep` for squared error and Laplacian bits of the default profile, with any C and width of MLP_p.

    networks: MLP_p of each coding stage, which does not train. Noise is a hash of (its key, column, seed), so that a
    step does not depend on the number of threads. MLP_p runs every `REFRESH` steps, from what neighbours are then: they
    move slowly, and all seeds can be evaluated at once although coding visits them pass by pass.
    """

    def __init__(
        self, spec: ModelSpec, seed: int, networks: Sequence[IntNetwork], raster: Backend, device: Device
    ) -> None:
        weights = float_weights(networks)
        self.native = _native.SeedFit(device.isa, device.threads, spec.channels, spec.context.hidden, *weights)
        self.spec, self.seed, self.raster = spec, seed, raster
        self.age = 0

    def set_layout(self, layout: SeedLayout, colour_step: int) -> None:
        """Prepares everything that depends on where the seeds are."""
        neighbour = neighbour_table(self.spec.context, layout)
        self.native.set_layout(layout.half_pixels, layout.log_size, neighbour, colour_step)
        self.count = len(layout)
        self.age = 0

    def run(
        self, parameters: Parameters, rounding: Rounding, number: int, level: PyramidLevel, lmbda: float
    ) -> StepResult:
        """As `GradientStep.run`."""
        colour, shape, offset = (parameters.seeds.values[name] for name in _GROUPS)
        noise, steps = NoiseKey.of(self.seed, number), parameters.steps
        gaussians = empty_gaussians(self.count, self.spec.channels)
        how = ROUNDINGS[rounding], noise.key, noise.negative, self.age == 0
        bits = self.native.forward(colour, shape, offset, steps, *how, *gaussians)
        self.age = (self.age + 1) % REFRESH if rounding != "none" else 0
        error, slopes = self._draw(gaussians, level)
        d_colour, d_shape, d_offset, d_steps = (np.empty_like(array) for array in (colour, shape, offset, steps))
        self.native.backward(*slopes, lmbda, d_colour, d_shape, d_offset, d_steps)
        gradients = {"colour": d_colour, "shape": d_shape, "offset": d_offset}
        return StepResult(error, bits, gradients if rounding == "none" else gradients | {"steps": d_steps})

    def _draw(self, gaussians: tuple[F32, F32, F32], level: PyramidLevel) -> tuple[float, tuple[F32, F32, F32]]:
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
