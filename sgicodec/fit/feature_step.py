"""A step of the paper profile in native code: loss and gradients without automatic differentiation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sgicodec import _native
from sgicodec.arrays import F32
from sgicodec.device import Device
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.parameters import Parameters, StepResult
from sgicodec.fit.pyramid import PyramidLevel
from sgicodec.fit.seed_step import ROUNDINGS
from sgicodec.fit.weight_bits import price_slope, with_weight_noise
from sgicodec.model.context import LEVELS
from sgicodec.model.gaussians import decoder_parts, empty_gaussians
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import FitSettings, Rounding
from sgicodec.raster.backend import Backend, Errors

MIN_SAMPLED = 1000
"""Seeds whose bits are counted in a step, where there are as many: 5 % of few seeds are too few to learn from
(docs/notes/2026-11-paper-profile.md)."""

_GROUPS = ("feature", "scales", "offset")


class FeatureInputs(NamedTuple):
    """What a step computes from: values [N, D], [N, 4] and [N, 2 K]; the weights of MLP_c and MLP_Σ, those of MLP_p as
    in `ContextWeights`, θ of all tables and log2 of the base steps [d_A], flat; the share of seeds whose bits count;
    price: λ of one bit.
    """

    values: tuple[F32, F32, F32]
    decoders: F32
    first: F32
    rest: F32
    tables: F32
    steps: F32
    rounding: Rounding
    priced: bool
    noise: NoiseKey
    share: float
    price: float


class FeatureOutputs(NamedTuple):
    """Squared error, bits of all seeds, and gradients: of the values, of what all seeds share (decoders, then b1, W2,
    b2 and W1 of MLP_p where bits count), and there of θ.
    """

    error: float
    bits: float
    values: tuple[F32, F32, F32]
    sums: F32
    tables: F32


class FeatureStep:
    """A `GradientStep` for mean absolute error and Gaussian bits of the paper profile.

    size: of the picture (W, H). Noise is a hash of (its key, column, seed), so that a step does not depend on the
    number of threads.
    """

    def __init__(
        self, spec: ModelSpec, settings: FitSettings, raster: Backend, size: tuple[int, int], device: Device
    ) -> None:
        context = spec.context
        hashed = list(context.hash_resolutions), context.hash_features, context.hash_log2_entries
        sizes = spec.per_seed, spec.channels, spec.features, spec.hidden, context.hidden
        self.native = _native.FeatureFit(device.isa, device.threads, *sizes, *hashed)
        self.spec, self.settings, self.raster, self.size = spec, settings, raster, size

    def set_layout(self, layout: SeedLayout, colour_step: int) -> None:
        """As `GradientStep.set_layout`."""
        self.native.set_layout(layout.half_pixels, colour_step, *self.size)
        self.count = len(layout)

    def run(
        self, parameters: Parameters, rounding: Rounding, number: int, level: PyramidLevel, lmbda: float
    ) -> StepResult:
        """As `GradientStep.run`."""
        seeds, context, noise = parameters.seeds, parameters.context, NoiseKey.of(self.settings.seed, number)
        assert context is not None
        feature, scales, offset = (seeds.values[name] for name in _GROUPS)
        priced, decoders = rounding == "noise" and lmbda > 0, seeds.decoder_weights
        if priced:
            decoders = with_weight_noise(decoders, seeds.decoder_shift, noise, self.spec.attributes + 1)
        given = FeatureInputs(
            values=(feature, scales, offset),
            decoders=decoders,
            first=context.first,
            rest=context.rest,
            tables=context.tables,
            steps=parameters.steps[: self.spec.attributes * LEVELS : LEVELS].copy(),
            rounding=rounding,
            priced=priced,
            noise=noise,
            share=min(1.0, max(self.settings.rate_sample, MIN_SAMPLED / self.count)),
            price=lmbda / (self.count * self.spec.attributes),
        )
        outputs = self._evaluate(given, level)
        if priced:
            for name, slopes in decoder_parts(self.spec, outputs.sums).items():
                if slopes.ndim == 2:
                    slopes += price_slope(seeds.decoders[name], seeds.decoder_shift, given.price)
        gradients = dict(zip(_GROUPS, outputs.values, strict=True))
        gradients |= {f"decoder_{name}": slopes for name, slopes in seeds.by_network(outputs.sums).items()}
        if priced:
            gradients |= context.gradients(outputs.sums[len(decoders) :], outputs.tables, given.price)
        return StepResult(outputs.error, outputs.bits, gradients)

    def _evaluate(self, given: FeatureInputs, level: PyramidLevel) -> FeatureOutputs:
        """The step but for what weights cost."""
        gaussians = empty_gaussians(self.count * self.spec.per_seed, self.spec.channels)
        feature, scales, offset = given.values
        bits = self.native.forward(
            *(feature, scales, offset, given.decoders, given.first, given.rest, given.tables, given.steps),
            *(ROUNDINGS[given.rounding], given.priced, given.noise.key, given.noise.negative),
            *(level.scale, given.share),
            *gaussians,
        )
        (_, error), slopes = self._draw(gaussians, level)
        values = np.empty_like(feature), np.empty_like(scales), np.empty_like(offset)
        sums = np.empty(self.native.sums(given.priced), np.float32)
        tables = np.empty_like(given.tables)
        self.native.backward(*slopes, given.price / given.share, given.price, *values, sums, tables)
        return FeatureOutputs(error, bits, values, sums, tables)

    def _draw(self, gaussians: tuple[F32, F32, F32], level: PyramidLevel) -> tuple[Errors, tuple[F32, F32, F32]]:
        """Mean absolute error and the sum of squares, and the gradients of the former in the Gaussians."""
        return self.raster.error(*gaussians, level.samples, "absolute", 1.0 / level.samples.size, level.weights)
