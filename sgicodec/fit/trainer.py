"""Fits seeds to a picture: free, then under noise and a price on bits, then on the values that will be decoded."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec.device import Device
from sgicodec.fit.adam import Adam, Group
from sgicodec.fit.context_training import ContextNet
from sgicodec.fit.densification import worthwhile_cells
from sgicodec.fit.fused_step import NoiseKey, SeedStep
from sgicodec.fit.pyramid import pyramid
from sgicodec.fit.quantization_noise import Sample, Sampler
from sgicodec.fit.raster_op import rasterize, squared_error
from sgicodec.fit.schedule import Pace, evenly, passed
from sgicodec.fit.seed_set import Population
from sgicodec.fit.settings import SLOWED, FitSettings, Phase, quality_index
from sgicodec.model.context import HashGrid
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, default_plan
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.rate_control.lambda_controller import LambdaController
from sgicodec.rate_control.target import Measured

__all__ = ["Fitted", "Progress", "Trainer"]

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Progress:
    """What a fit knows of itself after a step: psnr in dB before rounding to samples, bits of the seed attributes."""

    step: int
    steps: int
    seeds: int
    psnr: float
    bits: float
    seconds: float


@dataclass
class Fitted:
    """A fit's outcome: float attributes by group [N, size] in the layout's order, and the integers that code them."""

    layout: SeedLayout
    attributes: dict[str, NDArray[np.float64]]
    decoders: dict[str, NDArray[np.float64]]
    plan: StepPlan
    networks: tuple[IntNetwork, ...]
    hash_bits: list[NDArray[np.int64]]
    quality: int
    lmbda: float


class Trainer:
    """One picture's fit. `target` [C, H, W] is the picture less its base layer, samples in 0..1.

    `controller` moves λ towards a goal, with `measure` to tell what a model's stream would be; `seconds` replaces the
    number of steps.

    MLP_p is one of three: `networks`, integers to which the fit adds a small difference; `net`, which somebody else
    trains with the gradients that each step leaves; or, without either, a new one that turns into integers at the end.
    """

    def __init__(
        self,
        spec: ModelSpec,
        settings: FitSettings,
        target: F32,
        layout: SeedLayout,
        family: int,
        networks: tuple[IntNetwork, ...] | None = None,
        net: ContextNet | None = None,
        controller: LambdaController | None = None,
        measure: Callable[[Fitted], Measured] | None = None,
        seconds: float | None = None,
    ) -> None:
        self.spec, self.settings = spec, settings
        self.lmbda, self.controller, self.measure = settings.lmbda, controller, measure
        self.pace = Pace(settings.phases, seconds)
        self.generator = torch.Generator().manual_seed(settings.seed)
        self.raster = NativeRasterizer(Device(settings.threads))
        self.targets = pyramid(target, max(phase.level for phase in settings.phases) + 1)
        context = spec.context
        sizes = HashGrid.at(context, layout, target.shape[2], target.shape[1]).sizes if context.hash_resolutions else ()
        self.net = net or ContextNet(spec, sizes, self.generator)
        self.trains_net = net is None and networks is None
        self.networks = networks
        if networks is not None:
            self.net.load_integers(networks)
            self.net.adapt()
        self.quality = self._quality()
        self.sampler = Sampler(spec, self.net, default_plan(spec, self.quality), family)
        self.seed_step: SeedStep | None = None
        if family and settings.loss == "squared" and SeedStep.can_run(spec):
            self.seed_step = SeedStep(spec, self.raster, settings.threads)
        self.seeds = Population(spec, layout, target, self.generator)
        self.optimizer = self._optimizer()
        self._set_layout()
        self.step = 0

    def run(self, on_progress: Callable[[Progress], bool] | None = None) -> Fitted:
        """All phases. `on_progress` is called after each step; False from it ends the fit with what is there."""
        for progress in self.iterate():
            if on_progress is not None and not on_progress(progress):
                break
        return self.result()

    def iterate(self) -> Iterator[Progress]:
        """Steps one at a time through all phases."""
        for index, phase in enumerate(self.settings.phases):
            self._begin(phase)
            prunes, growths = evenly(phase.prune), evenly(phase.grow)
            checks = list(self.controller.checks) if self.controller is not None and phase.rounding == "noise" else []
            for fraction in self.pace.within(index):
                error, bits = self._step(phase)
                psnr = -10 * math.log10(max(error / self.targets[phase.level].numel(), 1e-12))
                untouched = len(prunes) == phase.prune
                if passed(prunes, fraction):
                    self._prune(psnr if untouched else None)
                if passed(growths, fraction):
                    self._grow()
                self.step += 1
                if self.controller is not None and phase.rate:
                    self._update_lmbda(self.controller, bits, psnr, passed(checks, fraction))
                yield Progress(self.step, self.pace.steps, len(self.seeds), psnr, bits, self.pace.elapsed)

    def _update_lmbda(self, controller: LambdaController, bits: float, psnr: float, check: bool) -> None:
        done, steps = self.pace.done, self.pace.steps
        self.lmbda = controller.update(done, steps, bits, len(self.seeds), psnr)
        if check and self.measure is not None:
            controller.correct(done, steps, self.measure(self.result()))

    def _begin(self, phase: Phase) -> None:
        """From the round phase on, everything but the seeds is what the stream will hold."""
        if phase.rounding == "round":
            self.networks = self._integers()
            self.net.load_integers(self.networks)
            self.sampler.load_plan(self.sampler.plan())
        live = {"steps": phase.learn_steps, "context": phase.rate}
        self.live = {group.name: live.get(group.name, True) for group in self.optimizer.groups}

    def _step(self, phase: Phase) -> tuple[float, float]:
        self._schedule()
        self.optimizer.clear()
        native = self.seed_step
        squared, bits = self._gradients(phase) if native is None else self._native_gradients(native, phase)
        self.optimizer.step()
        return squared, bits

    def _native_gradients(self, step: SeedStep, phase: Phase) -> tuple[float, float]:
        lmbda = self.lmbda if phase.rate else 0.0
        pair, second = divmod(self.step, 2)  # the error that noise makes of first order goes out in pairs
        noise = NoiseKey((self.settings.seed * 0x9E3779B1 + pair * 0x85EBCA77) & 0xFFFFFFFF, bool(second))
        target = self.targets[phase.level].numpy()
        steps = self.sampler.steps
        return step.run(self.seeds.values, self.net, steps, phase.rounding, noise, target, 0.5**phase.level, lmbda)

    def _gradients(self, phase: Phase) -> tuple[float, float]:
        sample = self._sample(phase)
        gaussians = self.seeds.gaussians(sample.attributes, phase.level)
        target = self.targets[phase.level]
        if self.settings.loss == "squared":
            error = squared_error(*gaussians, target, self.raster)
            loss, squared = error, float(error.detach())
            if phase.rate:
                loss = loss + self.lmbda * (sample.bits.sum() + self._side_bits())
        else:
            image = rasterize(*gaussians, (target.shape[2], target.shape[1]), self.raster)
            loss = (image - target).abs().mean()
            squared = float(((image.detach() - target) ** 2).sum())
            if phase.rate:
                price = self.lmbda / (len(self.seeds) * self.spec.attributes)
                loss = loss + price * (self._sampled_bits(sample) + self._side_bits())
        loss.backward()  # type: ignore[no-untyped-call]
        return squared, float(sample.bits.detach().sum())

    def _side_bits(self) -> Tensor:
        return self.net.hash_bits() + self.net.difference_bits()

    def _integers(self) -> tuple[IntNetwork, ...]:
        """The networks as the stream would hold them now."""
        if self.networks is None:
            return self.net.to_integers(WEIGHT_SHIFT)
        return self.net.adapted(self.networks)

    def _sample(self, phase: Phase) -> Sample:
        if phase.rounding == "none":
            return Sample(self.seeds.attributes(), torch.zeros(len(self.seeds)))
        return self.sampler.sample(self.seeds.values, phase.rounding, self.generator)

    def _sampled_bits(self, sample: Sample) -> Tensor:
        share = self.settings.rate_sample
        if share >= 1:
            return sample.bits.sum()
        chosen = torch.rand(len(sample.bits), generator=self.generator) < share
        return sample.bits[chosen].sum() / share

    def _schedule(self) -> None:
        rates = self.settings.rates
        decay = rates.left(self.pace.done)
        slow = self.settings.slowing(self.pace.steps)
        for group in self.optimizer.groups:
            speed = (1.0 if group.name in rates.constant else decay) * (slow if group.name in SLOWED else 1.0)
            group.factor = speed * self.live[group.name]

    def _prune(self, first_psnr: float | None) -> None:
        """Drops seeds whose Gaussians hold less squared error than their bits cost; the first time, λ is foreseen from
        the PSNR so far.
        """
        energy = self.seeds.energy()
        price = self.settings.prune * self.settings.seed_bits
        floor = price * self.lmbda
        if first_psnr is not None and self.controller is not None and self.seed_step is not None:
            bits, steps = self.seed_step.bits(), self.pace.steps
            floor = price * self.controller.update_before_pruning(energy.numpy(), bits, price, first_psnr, steps)
            self.lmbda = self.controller.lmbda
        keep = energy > floor
        keep[energy.argmax()] = True  # a model without seeds has no gradients
        if not bool(keep.all()):
            self.seeds.keep(keep, self.optimizer)
            self._set_layout()

    def _grow(self) -> None:
        """Adds seeds where the residual of the exact values is worth more than their bits."""
        target = self.targets[0]
        with torch.no_grad():
            gaussians = self.seeds.gaussians(self.seeds.attributes())
            residual = target - rasterize(*gaussians, (target.shape[2], target.shape[1]), self.raster)
        price = self.lmbda * self.settings.seed_bits * self.settings.growth
        added, means = worthwhile_cells(residual.numpy(), self.seeds.layout, price)
        if len(added):
            self.seeds.add(added, means, self.optimizer)
            self._set_layout()

    def _set_layout(self) -> None:
        """Tells everybody where the seeds are now."""
        layout, self.quality = self.seeds.layout, self._quality()
        _, height, width = self.targets[0].shape
        if self.seed_step is not None:
            self.seed_step.set_layout(layout, self.quality)
        else:
            self.sampler.set_layout(layout, self.quality, width, height)

    def _quality(self) -> int:
        return quality_index(self.lmbda) if self.settings.quality is None else self.settings.quality

    def _optimizer(self) -> Adam:
        rates = self.settings.rates
        groups = [Group(name, [value], getattr(rates, name)) for name, value in self.seeds.values.items()]
        for net in ("colour", "shape"):
            weights = [tensor for name, tensor in self.seeds.decoders.items() if name.startswith(net)]
            groups.append(Group(f"decoder_{net}", weights, getattr(rates, f"decoder_{net}")))
        groups.append(Group("steps", [self.sampler.steps], rates.steps))
        trained = self.net.parameters() if self.trains_net else []
        if self.net.difference is not None:
            trained = [self.net.difference]
        groups.append(Group("context", trained, rates.context))
        return Adam(groups, rates.betas, rates.epsilon)

    def result(self) -> Fitted:
        """What the fit has found so far, in the stream's order."""
        order = self.seeds.layout.order()
        values = {name: value.detach().numpy().astype(np.float64)[order] for name, value in self.seeds.values.items()}
        decoders = {name: tensor.detach().numpy().astype(np.float64) for name, tensor in self.seeds.decoders.items()}
        return Fitted(
            self.seeds.layout.take(order),
            values,
            decoders,
            self.sampler.plan(),
            self._integers(),
            self.net.signs(),
            self.quality,
            self.lmbda,
        )


WEIGHT_SHIFT = 8
"""MLP_p's own weights are multiples of 2^-8."""
