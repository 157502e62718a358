"""Bits of a fit's attributes and their gradients in float64, by automatic differentiation: what kernels are held to."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec.fit.autograd.context_net import ContextNet
from sgicodec.fit.autograd.quantization_proxy import QuantizationProxy
from sgicodec.fit.fused_step import NoiseKey
from sgicodec.fit.parameters import Parameters
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import Rounding

__all__ = ["rate_gradients"]

F64 = NDArray[np.float64]
_MASK = 0xFFFFFFFF


class _Noise(QuantizationProxy):
    """With the noise that the kernels hash, column by column."""

    column, key = 0, NoiseKey(0, False)

    def _perturb(  # type: ignore[override]
        self, value: Tensor, m: Tensor, q: Tensor, s: Tensor, rounding: Rounding, generator: torch.Generator
    ) -> Tensor:
        columns = [_noise(self.key, self.column + j, len(value)) for j in range(value.shape[1])]
        self.column += value.shape[1]
        return value + q * torch.from_numpy(np.stack(columns, axis=1))


def rate_gradients(
    spec: ModelSpec, parameters: Parameters, quality: int, key: NoiseKey, size: tuple[int, int]
) -> tuple[float, dict[str, F64]]:
    """Bits of a step with noise from `key`, and their gradients by the name of what trains, of a picture of this width
    and height.
    """
    context: Any = copy.copy(parameters.context)
    context.first, context.rest = (array.astype(np.float64) for array in (context.first, context.rest))
    net, proxy = ContextNet(context), _Noise(spec, 1)
    proxy.key = key
    proxy.set_layout(parameters.seeds.layout, quality, *size)
    for name in ("level_inputs", "log_size", "present", "offset"):
        setattr(proxy, name, getattr(proxy, name).double())
    own = {**parameters.seeds.values, "steps": parameters.steps}
    leaves = {name: torch.from_numpy(array.astype(np.float64)).requires_grad_() for name, array in own.items()}
    values = {name: leaves[name] for name in parameters.seeds.values}
    bits = proxy.sample(values, net, leaves["steps"], "noise", torch.Generator()).bits.sum()
    bits.backward()  # type: ignore[no-untyped-call]
    grads = {name: leaf.grad.numpy() for name, leaf in (leaves | net.leaves).items() if leaf.grad is not None}
    return float(bits.detach()), grads


def _noise(key: NoiseKey, column: int, seeds: int) -> F64:
    """lowbias32 over seed, column and key, in −0.5 to 0.5."""
    x = (np.arange(seeds, dtype=np.uint64) * 0x9E3779B9) & _MASK
    x ^= np.uint64((key.key + column * 0x85EBCA6B) & _MASK)
    x = ((x ^ (x >> np.uint64(16))) * np.uint64(0x7FEB352D)) & _MASK
    x = ((x ^ (x >> np.uint64(15))) * np.uint64(0x846CA68B)) & _MASK
    x ^= x >> np.uint64(16)
    found: F64 = ((x >> np.uint64(8)).astype(np.float64) + 0.5) / 2**24 - 0.5
    return -found if key.negative else found
