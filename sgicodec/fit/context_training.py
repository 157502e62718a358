"""MLP_p and the hash grid while they train: floats that become the integers of `model.network`."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
import torch
from torch import Tensor

from sgicodec.model.context import INPUT_BITS, HashGrid, hash_inputs, input_count, output_count
from sgicodec.model.network import DIFFERENCE_SHIFT, INPUT_LIMIT, IntNetwork
from sgicodec.model.spec import ModelSpec

__all__ = ["ContextNet", "binarize"]


class _Sign(torch.autograd.Function):
    """±1 forward; backward the identity where |θ| ≤ 1 (straight-through estimation, Shin and Park 2023)."""

    @staticmethod
    def forward(ctx: object, theta: Tensor) -> Tensor:
        ctx.save_for_backward(theta)  # type: ignore[attr-defined]
        return torch.where(theta >= 0, 1.0, -1.0)

    @staticmethod
    def backward(ctx: object, *grads: Tensor) -> Tensor:
        theta: Tensor = ctx.saved_tensors[0]  # type: ignore[attr-defined]
        return grads[0] * (theta.abs() <= 1)


def binarize(theta: Tensor) -> Tensor:
    """Signs of θ with straight-through gradients."""
    return cast(Tensor, _Sign.apply(theta))  # type: ignore[no-untyped-call]


class ContextNet:
    """One two-layer network per coding step, and the hash grid's tables θ [entries, F] per resolution."""

    def __init__(self, spec: ModelSpec, hash_sizes: tuple[int, ...], generator: torch.Generator) -> None:
        self.spec = spec
        self.layers: list[list[Tensor]] = []
        for number, step in enumerate(spec.context.steps):
            inputs, hidden = input_count(spec, number), spec.context.hidden
            outputs = sum(2 * output_count(spec, group) for group in step) + len(step)
            w1 = torch.randn(hidden, inputs, generator=generator) * (2.0 / inputs) ** 0.5
            w2 = torch.randn(outputs, hidden, generator=generator) * 0.1 / hidden**0.5
            self.layers.append([w1, torch.zeros(hidden), w2, torch.zeros(outputs)])
        features = spec.context.hash_features
        self.tables = [(torch.rand(n, features, generator=generator) * 2 - 1) * 1e-2 for n in hash_sizes]
        for parameter in self.parameters():
            parameter.requires_grad_()
        self.difference: Tensor | None = None

    def adapt(self) -> Tensor:
        """Lets everything but the first layer's weights differ from what it is now. Returns what then trains: b1, W2
        and b2 of every step, flat.
        """
        self.difference = torch.zeros_like(self.flat_rest()).requires_grad_()
        counts = torch.tensor([tensor.numel() for layer in self.layers for tensor in layer[1:]])
        self._counts, self._tensor = counts.float(), torch.repeat_interleave(torch.arange(len(counts)), counts)
        return self.difference

    def difference_bits(self) -> Tensor:
        """About what the differences cost: each tensor under the Laplacian of its own mean magnitude."""
        if self.difference is None:
            return torch.zeros(())
        size = self.difference.abs() * 2.0**DIFFERENCE_SHIFT
        sums = torch.zeros_like(self._counts).index_add_(0, self._tensor, size.detach())
        mean = sums / self._counts + 0.05
        spent = (size / (mean * math.log(2.0))[self._tensor]).sum()
        return spent + (self._counts * torch.log2(1.0 + 2.0 * mean)).sum()

    def flat_first(self) -> Tensor:
        """W1 of every step, flat."""
        return torch.cat([layer[0].reshape(-1) for layer in self.layers])

    def flat_rest(self) -> Tensor:
        """b1, W2 and b2 of every step with their differences, flat."""
        rest = torch.cat([tensor.reshape(-1) for layer in self.layers for tensor in layer[1:]])
        return rest if self.difference is None else rest + self.difference

    def parameters(self) -> list[Tensor]:
        """Everything that trains."""
        return [tensor for layer in self.layers for tensor in layer] + self.tables

    @property
    def first_layer_is_fixed(self) -> bool:
        """Whether products with W1 may be kept from step to step."""
        return not any(layer[0].requires_grad for layer in self.layers)

    def product(self, step: int, inputs: Tensor, start: int = 0) -> Tensor:
        """W1 times inputs [n, k] in units of 2^-6 that stand at columns `start` … of all inputs [n, hidden]."""
        x = inputs.clamp(-INPUT_LIMIT, INPUT_LIMIT) * 2.0**-INPUT_BITS
        return x @ self.layers[step][0][:, start : start + inputs.shape[1]].T

    def forward(self, step: int, inputs: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Means in base steps [n, U], scales [n, U] and refinements [n, G] in octaves, from inputs in units of 2^-6."""
        return self.predict(step, self.product(step, inputs))

    def predict(self, step: int, product: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """The same from W1 times all inputs."""
        b1, w2, b2 = self._effective(step)
        out = torch.addmm(b2, torch.relu(product + b1), w2.T)
        units = sum(output_count(self.spec, group) for group in self.spec.context.steps[step])
        return out[:, :units], out[:, units : 2 * units], out[:, 2 * units :]

    def _effective(self, step: int) -> list[Tensor]:
        """b1, W2 and b2 with their differences."""
        rest = self.layers[step][1:]
        if self.difference is None:
            return rest
        return [own + more for own, more in zip(rest, self._differences(self.difference)[step], strict=True)]

    def _differences(self, flat: Tensor) -> list[list[Tensor]]:
        """The differences in the shapes of b1, W2 and b2 of every step."""
        shapes = [tensor.shape for layer in self.layers for tensor in layer[1:]]
        parts = torch.split(flat, [shape.numel() for shape in shapes])
        shaped = [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]
        return [shaped[at : at + 3] for at in range(0, len(shaped), 3)]

    def hash_features(self, grid: HashGrid, weight: Tensor) -> Tensor:
        """H at every seed [N, L·F], in input units."""
        signs = [binarize(table) for table in self.tables]
        return cast(
            Tensor,
            hash_inputs(grid, slice(None), signs, weight, torch.cat, lambda value, shift: value * 2.0**-shift),
        )

    def hash_bits(self) -> Tensor:
        """L_hash: the entropy of the grid's signs (paper, equation 12)."""
        total = torch.zeros(())
        for table in self.tables:
            share = (binarize(table) * 0.5 + 0.5).mean().clamp(1e-6, 1 - 1e-6)
            total = total - table.numel() * (share * share.log2() + (1 - share) * (1 - share).log2())
        return total

    def to_integers(self, shift: int) -> tuple[IntNetwork, ...]:
        """The networks that coding uses: weights rounded to 2^-shift."""
        networks = []
        for number, step in enumerate(self.spec.context.steps):
            w1, b1, w2, b2 = (
                np.rint(t.detach().numpy().astype(np.float64) * 2.0**shift).astype(np.int64)
                for t in (self.layers[number][0], *self._effective(number))
            )
            predicted = sum(output_count(self.spec, group) for group in step)
            networks.append(IntNetwork(w1, b1, w2, b2, shift, predicted))
        return tuple(networks)

    def load_integers(self, networks: tuple[IntNetwork, ...], trainable: bool = False) -> None:
        """Sets the weights to what the integer networks hold; differences end."""
        self.difference = None
        for layer, network in zip(self.layers, networks, strict=True):
            for index, values in enumerate((network.w1, network.b1, network.w2, network.b2)):
                weights = torch.tensor(values * 2.0**-network.shift, dtype=torch.float32)
                layer[index] = weights.requires_grad_(trainable)

    def adapted(self, networks: tuple[IntNetwork, ...]) -> tuple[IntNetwork, ...]:
        """`networks` with the differences added, rounded to what a stream carries."""
        if self.difference is None:
            return networks
        result = []
        for network, layer in zip(networks, self._differences(self.difference), strict=True):
            b1, w2, b2 = (
                np.rint(t.detach().numpy().astype(np.float64) * 2.0**DIFFERENCE_SHIFT).astype(np.int64) for t in layer
            )
            result.append(network.plus(b1, w2, b2))
        return tuple(result)

    def signs(self) -> list[np.ndarray]:
        """The grid's bits as 0 or 1, [entries, F] per resolution."""
        return [(table.detach() >= 0).numpy().astype(np.int64) for table in self.tables]
