"""Bits of a fit's attributes and their gradients in float64, by automatic differentiation: what kernels are held to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from sgicodec.fit.context_weights import float_weights
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.parameters import Parameters
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from tests.support.torch_step.context_net import ContextNet
from tests.support.torch_step.quantization_proxy import QuantizationProxy

__all__ = ["rate_gradients"]

F64 = NDArray[np.float64]


def rate_gradients(
    spec: ModelSpec,
    networks: Sequence[IntNetwork],
    parameters: Parameters,
    quality: int,
    key: NoiseKey,
    size: tuple[int, int],
) -> tuple[float, dict[str, F64]]:
    """Bits of a step with noise from `key`, and their gradients by the name of what trains, of a picture of this width
    and height.
    """
    first, rest = (array.astype(np.float64) for array in float_weights(networks))
    net, proxy = ContextNet(spec, (first, rest)), QuantizationProxy(spec, 1)
    proxy.set_layout(parameters.seeds.layout, quality, *size)
    for name in ("level_inputs", "log_size", "present", "offset"):
        setattr(proxy, name, getattr(proxy, name).double())
    own = {**parameters.seeds.values, "steps": parameters.steps}
    leaves = {name: torch.from_numpy(array.astype(np.float64)).requires_grad_() for name, array in own.items()}
    values = {name: leaves[name] for name in parameters.seeds.values}
    bits = proxy.sample(values, net, leaves["steps"], "noise", key).bits.sum()
    bits.backward()  # type: ignore[no-untyped-call]
    grads = {name: leaf.grad.numpy() for name, leaf in leaves.items() if leaf.grad is not None}
    return float(bits.detach()), grads
