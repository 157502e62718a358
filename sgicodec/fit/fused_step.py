"""A step of the default profile in native code: what `Sampler`, `gaussians_from_seeds` and autograd do elsewhere."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec import _native
from sgicodec.fit.context_training import ContextNet
from sgicodec.fit.settings import Rounding
from sgicodec.model.context import INPUT_BITS, LEVELS, level_inputs, nearest_offset, neighbour_table
from sgicodec.model.gaussians import MIN_VARIANCE, colour_matrix
from sgicodec.model.layout import SeedLayout
from sgicodec.model.neighbours import nearest_seeds
from sgicodec.model.spec import ModelSpec
from sgicodec.raster.cpu import NativeRasterizer

__all__ = ["SeedStep"]

F32 = NDArray[np.float32]

_ROUNDINGS: dict[Rounding, int] = {"none": 0, "noise": 1, "round": 2}
_GROUPS = ("colour", "shape", "offset")
_FLOOR = np.array([MIN_VARIANCE, 0.0, MIN_VARIANCE], np.float32)


class Reuse(Enum):
    """What a step takes over from those before it: nothing, inputs from neighbours, or all that MLP_p predicts."""

    NOTHING, INPUTS, PREDICTIONS = range(3)


class NoiseKey(NamedTuple):
    """What noise is a hash of, in 32 bits; `negative` for that noise with its signs turned."""

    key: int
    negative: bool


class SeedStep:
    """Squared error plus λ times bits, those of MLP_p's difference included, and the gradients, for the models that
    `can_run` names.

    Noise is a hash of (its key, column, seed), so that a step does not depend on the number of threads. Inputs from
    neighbours are found anew every `refresh` steps, as in `Sampler`. Under noise, where MLP_p is a prior's and only its
    difference trains, it runs every `predict` steps: in between, what it said and the gradients that its difference and
    the steps had then stand.
    """

    refresh, predict = 8, 4

    def __init__(self, spec: ModelSpec, raster: NativeRasterizer, threads: int) -> None:
        opponent = np.array(colour_matrix(spec.channels), np.float32)
        self.native = _native.SeedFit(raster.isa, threads, spec.per_seed, spec.context.hidden, opponent)
        self.spec, self.raster = spec, raster
        self.age = 0
        self.standing: list[tuple[Tensor, Tensor | None]] = []

    @staticmethod
    def can_run(spec: ModelSpec) -> bool:
        """Whether the native code has this model: the default profile's, with any K, C and width of MLP_p."""
        context = spec.context
        plain = spec.skip and not spec.hidden and not spec.seed_scales and spec.shape == "log"
        grouped = context.steps == tuple((name,) for name in _GROUPS) and not context.hash_resolutions
        return plain and grouped and 0 < context.neighbours <= _native.MOST_NEIGHBOURS

    def set_layout(self, layout: SeedLayout, quality: int) -> None:
        """Prepares everything that depends on where the seeds are."""
        table, present = neighbour_table(self.spec.context, layout, nearest_seeds)
        one = np.float32(2.0**-INPUT_BITS)
        self.native.set_layout(
            np.ascontiguousarray(layout.centre, np.float32),
            np.ascontiguousarray(layout.cell, np.float32),
            layout.log_size.astype(np.float32),
            np.clip(layout.log_size, 0, LEVELS - 1).astype(np.int32),
            np.where(present, table, -1).astype(np.int32),
            nearest_offset(layout, table).astype(np.float32) * one,
            level_inputs(layout, quality).astype(np.float32) * one,
        )
        self.count = len(layout)
        self.age = 0

    def run(
        self,
        values: dict[str, Tensor],
        net: ContextNet,
        steps: Tensor,
        rounding: Rounding,
        noise: NoiseKey,
        target: F32,
        scale: float,
        lmbda: float,
    ) -> tuple[float, float]:
        """Squared error against target [C, H, W] and bits of the seeds; leaves gradients at all that takes part.

        `scale` is the target's size as a fraction of the picture's; `steps` is laid out as `Sampler.steps`.
        """
        arrays = [values[name].detach().numpy() for name in _GROUPS]
        first, rest = net.flat_first(), net.flat_rest()
        gaussians = self._gaussian_arrays()
        colour, shape, offset = arrays
        reuse = self._reuse(rounding, net)
        bits = self.native.forward(
            colour,
            shape,
            offset,
            first.detach().numpy(),
            rest.detach().numpy(),
            steps.detach().numpy(),
            _ROUNDINGS[rounding],
            noise.key,
            noise.negative,
            reuse.value,
            not net.first_layer_is_fixed,
            *gaussians,
        )
        self.age = (self.age + 1) % self.refresh if rounding != "none" else 0
        error, grads = self._draw(gaussians, target, scale)
        for name, array in zip(_GROUPS, arrays, strict=True):
            values[name].grad = torch.from_numpy(np.empty_like(array))
        d_colour, d_shape, d_offset = (values[name].grad.numpy() for name in _GROUPS)  # type: ignore[union-attr]
        sums = np.empty(self.native.sums, np.float32)
        self.native.backward(*grads, lmbda, d_colour, d_shape, d_offset, sums)
        if rounding != "none":
            if reuse is Reuse.PREDICTIONS:
                for tensor, gradient in self.standing:
                    tensor.grad = gradient
            else:
                self._pass_on(torch.from_numpy(sums), steps, (rest, first))
                self._price_difference(net, lmbda)
                self.standing = [(t, t.grad) for t in (steps, net.difference) if t is not None]
        return error, bits

    def _reuse(self, rounding: Rounding, net: ContextNet) -> Reuse:
        if self.age == 0 or rounding == "none":
            return Reuse.NOTHING
        lazy = rounding == "noise" and net.difference is not None and self.age % self.predict
        return Reuse.PREDICTIONS if lazy else Reuse.INPUTS

    @staticmethod
    def _price_difference(net: ContextNet, lmbda: float) -> None:
        if net.difference is not None and lmbda:
            (lmbda * net.difference_bits()).backward()  # type: ignore[no-untyped-call]

    @staticmethod
    def _pass_on(gradient: Tensor, steps: Tensor, networks: tuple[Tensor, ...]) -> None:
        """Hands the sums over seeds (of b1, W2 and b2, then steps, then W1 if it trains) to what they belong to."""
        at = len(networks[0])
        steps.grad = gradient[at : at + len(steps)]
        parts = gradient[:at], gradient[at + len(steps) :]
        trained = [(tensor, part) for tensor, part in zip(networks, parts, strict=True) if tensor.requires_grad]
        if trained:
            torch.autograd.backward([tensor for tensor, _ in trained], [part for _, part in trained])

    def bits(self) -> F32:
        """Bits of every seed in the last step [N]."""
        out = np.empty(self.count, np.float32)
        self.native.bits(out)
        return out

    def _gaussian_arrays(self) -> tuple[F32, F32, F32]:
        n = self.count * self.spec.per_seed
        return np.empty((n, 2), np.float32), np.empty((n, 3), np.float32), np.empty((n, self.spec.channels), np.float32)

    def _draw(self, gaussians: tuple[F32, F32, F32], target: F32, scale: float) -> tuple[float, tuple[F32, F32, F32]]:
        """Squared error and its gradients in the Gaussians at full size, of a picture reduced by `scale`."""
        means, covariances, colours = gaussians
        if scale != 1.0:
            # Only the cells shrink with a level; MIN_VARIANCE stays a matter of the pixels that are drawn.
            less = np.float32(scale * scale)
            means, covariances = means * np.float32(scale), covariances * less + _FLOOR * (1 - less)
        error, (d_means, d_covariances, d_colours) = self.raster.squared_error(means, covariances, colours, target, 1.0)
        if scale != 1.0:
            d_means, d_covariances = d_means * np.float32(scale), d_covariances * np.float32(scale * scale)
        return error, (d_means, d_covariances, d_colours)
