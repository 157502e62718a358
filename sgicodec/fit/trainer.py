"""Fits seeds to a picture: free, then under noise and a price on bits, then on the values that will be decoded."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32
from sgicodec.device import ALL_CORES, Device
from sgicodec.fit.adam import Adam
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.densification import worthwhile_cells
from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.initialization import CellMeans
from sgicodec.fit.parameters import GradientStep, Parameters, learning_rate_of
from sgicodec.fit.pyramid import max_level, pyramid_levels
from sgicodec.fit.seed_set import SeedSet
from sgicodec.fit.seed_step import SeedStep
from sgicodec.fit.step_sizes import base_counts, flat_steps, rounded_plan
from sgicodec.model.context import LEVELS, hash_grid
from sgicodec.model.layout import ROOT_LOG, CellSums, SeedLayout, cell_sums
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, colour_step_of, default_plan
from sgicodec.profiles.fit_settings import SLOWED, FitSettings, Phase
from sgicodec.raster import backend_of
from sgicodec.raster.cpu import NativeRasterizer


@dataclass(frozen=True)
class Progress:
    """What a fit knows of itself after a step: psnr in dB before rounding to samples, bits of the seed attributes."""

    step: int
    steps: int
    seeds: int
    psnr: float
    bits: float


@dataclass
class Fitted:
    """A fit's outcome: float attributes by group [N, size] in the layout's order, and the integers that code them."""

    layout: SeedLayout
    attributes: dict[str, NDArray[np.float64]]
    decoders: dict[str, NDArray[np.float64]]
    decoder_shift: int
    plan: StepPlan
    networks: tuple[IntNetwork, ...]
    hash_bits: list[NDArray[np.int64]]
    colour_step: int


class Trainer:
    """One picture's fit. `target` [C, H, W] is the picture less its base layer, samples in 0..1, and `weights` [H, W]
    what their squared errors count, by default all the same.

    MLP_p is one of two: `networks`, which ship, or, without them, a new one that trains and turns into integers at the
    end.
    """

    def __init__(
        self,
        spec: ModelSpec,
        settings: FitSettings,
        target: F32,
        layout: SeedLayout,
        networks: tuple[IntNetwork, ...] | None = None,
        device: Device = ALL_CORES,
        weights: F32 | None = None,
    ) -> None:
        _, height, width = target.shape
        most = max_level(width, height)
        phases = tuple(replace(phase, level=min(phase.level, most)) for phase in settings.phases)
        settings = replace(settings, phases=phases)
        self.spec, self.settings, self.weights, self.device = spec, settings, weights, device
        self.mean_weights = None if weights is None else CellMeans(weights[None])
        self.raster = backend_of(device, spec.channels)
        self.levels = pyramid_levels(target, weights, max(phase.level for phase in phases) + 1)
        self.colour_step = colour_step_of(settings.lmbda) if settings.colour_step is None else settings.colour_step
        rng = np.random.default_rng(settings.seed)
        self.seeds = SeedSet(spec, layout, target, rng, device)
        self.seeds.decoder_shift += math.ceil(settings.finer_steps)
        self.networks = networks
        counts = hash_grid(spec.context, width, height).counts
        self.context = ContextWeights(spec, counts, rng) if networks is None else None
        steps = flat_steps(spec, default_plan(spec, self.colour_step))
        steps[: sum(base_counts(spec))] -= settings.finer_steps
        self.parameters = Parameters(self.seeds, steps, self.context)
        self.adam = Adam(settings.rates.betas, settings.rates.epsilon, device)
        self.gradient_step = self._gradient_step()
        self._place()
        self.step = 0
        self.centred = False

    @property
    def device_name(self) -> str:
        """What fits: the name of the GPU that draws, or the processor."""
        return self.raster.device_name

    def _gradient_step(self) -> GradientStep:
        """That of the profile: of the paper's, which trains MLP_p, a GPU that draws computes all."""
        if self.networks is not None:
            return SeedStep(self.spec, self.settings.seed, self.networks, self.raster, self.device)
        _, height, width = self.levels[0].samples.shape
        if isinstance(self.raster, NativeRasterizer):
            return FeatureStep(self.spec, self.settings, self.raster, (width, height), self.device)
        from sgicodec.fit.device_feature_step import DeviceFeatureStep

        return DeviceFeatureStep(self.spec, self.settings, self.raster, (width, height))

    def iterate(self) -> Iterator[Progress]:
        """Steps one at a time through all phases."""
        steps = self.settings.steps
        for phase in self.settings.phases:
            if phase.rounding == "round":
                self._fix_steps()
            if phase.rate:
                self._centre_context()
            for number in range(1, phase.steps + 1):
                error, bits = self._step(phase)
                psnr = -10 * math.log10(max(error / self.levels[phase.level].samples.size, 1e-12))
                if due(phase.prune, number, phase.steps):
                    self._prune()
                if due(phase.grow, number, phase.steps):
                    self._grow()
                self.step += 1
                yield Progress(self.step, steps, len(self.seeds), psnr, bits)

    def _fix_steps(self) -> None:
        """From the round phase on, steps are those that the stream will hold."""
        self.parameters.steps[:] = flat_steps(self.spec, rounded_plan(self.spec, self.parameters.steps))

    def _centre_context(self) -> None:
        """Lets a new MLP_p begin at every attribute's mean and deviation."""
        if self.context is not None and not self.centred:
            self.centred = True
            self.context.centre(self._in_base_steps())

    def _in_base_steps(self) -> F32:
        """The attributes of all groups as they are coded [N, d_A], where all seeds have cells of one pixel."""
        steps = flat_steps(self.spec, rounded_plan(self.spec, self.parameters.steps)).reshape(-1, LEVELS)
        return self.seeds.attributes() / 2.0 ** steps[:, :1].T

    def _step(self, phase: Phase) -> tuple[float, float]:
        """Squared error and bits of a step, after which everything that trains has moved."""
        lmbda = self.settings.lmbda * 0.25**phase.level if phase.rate else 0.0  # a level has a quarter of the pixels
        result = self.gradient_step.run(self.parameters, phase.rounding, self.step, self.levels[phase.level], lmbda)
        for name, array in self.parameters.trained().items():
            if name in result.gradients:
                self.adam.move(name, array, result.gradients[name], self._learning_rate(learning_rate_of(name), phase))
        return result.error, result.bits

    def _learning_rate(self, name: str, phase: Phase) -> float:
        rates = self.settings.rates
        speed = rates.left(name, self.step / self.settings.steps)
        speed *= self.settings.slowing() if name in SLOWED else 1.0
        trains = {"steps": phase.learn_steps, "context": phase.rate}.get(name, True)
        return float(getattr(rates, name) * (speed * trains))

    def _prune(self) -> None:
        """Drops seeds whose Gaussians hold less squared error than their bits cost."""
        energy = self.seeds.energy()
        if self.mean_weights is not None:
            energy = energy * self.mean_weights.of(self.seeds.layout)[:, 0]
        keep = energy > self.settings.prune * self.settings.seed_bits * self.settings.lmbda
        keep[energy.argmax()] = True  # a model without seeds has no gradients
        if not keep.all():
            self.seeds.keep(keep, self.adam)
            self._place()

    def _grow(self) -> None:
        """Adds seeds where the residual of the exact values is worth more than their bits."""
        price = self.settings.lmbda * self.settings.seed_bits * self.settings.growth
        added, means = worthwhile_cells(self._residual_sums(), self.seeds.layout, price)
        if len(added):
            self.seeds.add(added, means, self.adam)
            self._place()

    def _residual_sums(self) -> CellSums:
        target = self.levels[0].samples
        residual = target - self.raster.forward(*self.seeds.gaussians(), target.shape[2], target.shape[1])
        return cell_sums(residual, ROOT_LOG, self.weights, self.device.threads)

    def _place(self) -> None:
        """To be called where seeds have come or gone."""
        self.gradient_step.set_layout(self.seeds.layout, self.colour_step)

    def result(self) -> Fitted:
        """What the fit has found so far, in the stream's order."""
        if self.context is not None and not self.centred:
            self.context.say_constants(self._in_base_steps())  # it has learned nothing yet
        order = self.seeds.layout.order()
        return Fitted(
            self.seeds.layout.take(order),
            {name: value.astype(np.float64)[order] for name, value in self.seeds.coded().items()},
            {name: weights.astype(np.float64) for name, weights in self.seeds.decoders.items()},
            self.seeds.decoder_shift,
            rounded_plan(self.spec, self.parameters.steps),
            *self._context(),
            self.colour_step,
        )

    def _context(self) -> tuple[tuple[IntNetwork, ...], list[NDArray[np.int64]]]:
        """MLP_p and the hash grid's bits as the stream will hold them."""
        if self.context is None:
            return self.networks or (), []
        return (self.context.integers(),), self.context.signs()


def due(times: int, number: int, steps: int) -> bool:
    """Whether what happens so many times in `steps` steps, at even distances, is due after this one, the first being 1;
    what would be due more than once in a step happens once.
    """
    return min(times, number * (times + 1) // steps) > (number - 1) * (times + 1) // steps
