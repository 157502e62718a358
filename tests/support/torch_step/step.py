"""A step of any model by automatic differentiation in torch: the paper profile's, and what the native step lacks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec.fit.context_weights import float_weights
from sgicodec.fit.feature_step import MIN_SAMPLED
from sgicodec.fit.noise import NoiseKey, hashed_noise
from sgicodec.fit.parameters import Parameters, StepResult
from sgicodec.fit.pyramid import PyramidLevel
from sgicodec.fit.seed_set import coded_values
from sgicodec.fit.weight_bits import with_weight_noise
from sgicodec.model.gaussians import decoder_parts, gaussians_from_seeds
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import FitSettings, Rounding
from sgicodec.raster.backend import Backend, Loss
from tests.support.torch_step.context_net import ContextNet, bits_by_mean
from tests.support.torch_step.quantization_proxy import QuantizationProxy, Sample

F32 = NDArray[np.float32]


class AutogradStep:
    """A `GradientStep` with squared or mean absolute error for a picture of `size` (W, H); networks: that ship."""

    def __init__(
        self,
        spec: ModelSpec,
        settings: FitSettings,
        raster: Backend,
        family: int,
        size: tuple[int, int],
        networks: Sequence[IntNetwork] = (),
    ) -> None:
        self.spec, self.settings, self.raster, self.size = spec, settings, raster, size
        self.proxy, self.networks = QuantizationProxy(spec, family), networks

    def set_layout(self, layout: SeedLayout, colour_step: int) -> None:
        """As `GradientStep.set_layout`."""
        self.proxy.set_layout(layout, colour_step, *self.size)
        self._centre, self._cell = torch.from_numpy(layout.centre), torch.from_numpy(layout.cell)

    def run(
        self, parameters: Parameters, rounding: Rounding, number: int, level: PyramidLevel, lmbda: float
    ) -> StepResult:
        """As `GradientStep.run`."""
        with _one_thread():
            return self._run(parameters, rounding, NoiseKey.of(self.settings.seed, number), level, lmbda)

    def _run(
        self, parameters: Parameters, rounding: Rounding, key: NoiseKey, level: PyramidLevel, lmbda: float
    ) -> StepResult:
        net = ContextNet(self.spec, parameters.context or float_weights(self.networks))
        own = {name: a for name, a in parameters.trained().items() if name not in net.leaves}
        leaves = {name: torch.from_numpy(array).requires_grad_() for name, array in own.items()} | net.leaves
        values = coded_values({group.name: leaves[group.name] for group in self.spec.groups}, torch)
        if rounding == "none":
            joined = torch.cat(list(values.values()), dim=1)
            sample = Sample(joined, torch.zeros(len(joined)))
        elif rounding == "noise" and not lmbda and not self.spec.plain:
            sample = self.proxy.noisy(values, leaves["steps"], level.scale, key)
        else:
            sample = self.proxy.sample(values, net, leaves["steps"], rounding, key)
        networks = [leaf for name, leaf in leaves.items() if name.startswith("decoder_")]
        exact = decoder_parts(self.spec, torch.cat(networks)) if networks else {}
        priced = rounding == "noise" and lmbda > 0 and bool(exact)
        decoders = self._with_noise(exact, parameters.seeds.decoder_shift, key) if priced else exact
        gaussians = gaussians_from_seeds(
            self.spec,
            sample.attributes,
            self._centre * level.scale,
            self._cell * level.scale,
            decoders,
            torch,
        )
        side = net.hash_bits() + net.weight_bits()
        if priced:
            unit = 2.0**parameters.seeds.decoder_shift
            side = side + sum(bits_by_mean(weights.abs() * unit) for weights in exact.values() if weights.ndim == 2)
        loss, squared = self._loss(gaussians, level, sample, side, lmbda, key)
        loss.backward()  # type: ignore[no-untyped-call]
        gradients = {name: leaf.grad.contiguous().numpy() for name, leaf in leaves.items() if leaf.grad is not None}
        return StepResult(squared, float(sample.bits.detach().sum()), gradients)

    def _loss(
        self,
        gaussians: tuple[Tensor, Tensor, Tensor],
        level: PyramidLevel,
        sample: Sample,
        side: Tensor,
        lmbda: float,
        key: NoiseKey,
    ) -> tuple[Tensor, float]:
        """The loss, and the squared error without weights. side: bits of what all seeds share."""
        target, price = torch.from_numpy(level.samples), lmbda
        kind: tuple[Loss, float] = "squared", 1.0
        if not self.spec.plain:
            kind = "absolute", 1.0 / target.numel()
            price /= len(sample.bits) * self.spec.attributes
        loss, squared = error(gaussians, target, self.raster, *kind, level.weights)
        if lmbda:
            loss = loss + price * (self._sampled_bits(sample, key) + side)
        return loss, squared

    def _with_noise(self, decoders: dict[str, Tensor], shift: int, key: NoiseKey) -> dict[str, Tensor]:
        flat = np.zeros(sum(weights.numel() for weights in decoders.values()), np.float32)
        noise = torch.from_numpy(with_weight_noise(flat, shift, key, self.spec.attributes + 1))
        parts = torch.split(noise, [weights.numel() for weights in decoders.values()])
        return {
            name: decoders[name] + part.reshape(decoders[name].shape)
            for name, part in zip(decoders, parts, strict=True)
        }

    def _sampled_bits(self, sample: Sample, key: NoiseKey) -> Tensor:
        count = len(sample.bits)
        share = max(self.settings.rate_sample, MIN_SAMPLED / count)
        if share >= 1:
            return sample.bits.sum()
        chosen = torch.from_numpy(hashed_noise(key, self.spec.attributes, count) + 0.5 < share)
        return sample.bits[chosen].sum() / share


@contextmanager
def _one_thread() -> Iterator[None]:
    """With more threads torch's sums, powers and scattered additions depend on their number, some even on chance.

    The rasteriser, where the time goes, gives the same for any number.
    """
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


class _Error(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any,
        means: Tensor,
        covariances: Tensor,
        colours: Tensor,
        target: Tensor,
        raster: Backend,
        loss: Loss,
        weight: float,
        weights: F32 | None,
    ) -> tuple[Tensor, Tensor]:
        arrays = _arrays(means, covariances, colours)
        errors, ctx.grads = raster.error(*arrays, target.numpy(), loss, weight, weights)
        squared = torch.tensor(errors.squared, dtype=torch.float64)
        ctx.mark_non_differentiable(squared)
        return torch.tensor(errors.loss), squared

    @staticmethod
    def backward(ctx: Any, *grads: Tensor) -> tuple[Tensor | None, ...]:
        return (*(torch.from_numpy(g) * grads[0] for g in ctx.grads), None, None, None, None, None)


def error(
    gaussians: tuple[Tensor, Tensor, Tensor],
    target: Tensor,
    raster: Backend,
    loss: Loss = "squared",
    weight: float = 1.0,
    weights: F32 | None = None,
) -> tuple[Tensor, float]:
    """The loss of `Backend.error` over target [C, H, W], differentiable in the Gaussians, and Σ (I − target)²."""
    found, squared = _Error.apply(*gaussians, target, raster, loss, weight, weights)  # type: ignore[no-untyped-call]
    return cast(Tensor, found), float(squared)


def _arrays(means: Tensor, covariances: Tensor, colours: Tensor) -> tuple[F32, F32, F32]:
    first, second, third = (t.detach().contiguous().numpy() for t in (means, covariances, colours))
    return first, second, third
