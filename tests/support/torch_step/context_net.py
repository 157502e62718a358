"""MLP_p and the hash grid in torch: what they predict from inputs, differentiable in their weights."""

from __future__ import annotations

import math
from typing import Any

import torch
from torch import Tensor

from sgicodec._native import INPUT_LIMIT
from sgicodec.fit.context_weights import WEIGHT_SHIFT, ContextWeights, shaped
from sgicodec.fit.weight_bits import ADDED_UNITS
from sgicodec.model.context import INPUT_BITS, network_shapes, output_count
from sgicodec.model.spec import ModelSpec


def binarize(theta: Tensor) -> Tensor:
    """Signs of θ, ±1; backward the identity where |θ| ≤ 1 (straight-through estimation, Shin and Park 2023)."""
    near = theta.clamp(-1, 1)
    return torch.where(theta >= 0, 1.0, -1.0) + (near - near.detach())


def bits_by_mean(sizes: Tensor) -> Tensor:
    """Bits of integers of these magnitudes under the Laplacian of their mean, which is taken as given."""
    mean = sizes.detach().mean() + ADDED_UNITS
    return (sizes / (mean * math.log(2.0))).sum() + sizes.numel() * torch.log2(1.0 + 2.0 * mean)


class ContextNet:
    """MLP_p and the hash grid as tensors: the arrays of a `ContextWeights` on the same memory, which are `leaves` by
    their names there, or weights as `float_weights` has them, which do not train.
    """

    def __init__(self, spec: ModelSpec, weights: ContextWeights | tuple[Any, Any]) -> None:
        self.spec = spec
        self.leaves: dict[str, Tensor] = {}
        self.tables: list[Tensor] = []
        if isinstance(weights, ContextWeights):
            self.leaves = {name: torch.from_numpy(a).requires_grad_() for name, a in weights.trained().items()}
            first, rest, tables = (self.leaves[f"context.{name}"] for name in ("first", "rest", "tables"))
            self.tables = weights.per_table(tables)
        else:
            first, rest = map(torch.from_numpy, weights)
        shapes = [list(network_shapes(spec, step).values()) for step in range(len(spec.context.steps))]
        firsts: list[Tensor] = shaped([stage[0] for stage in shapes], first)
        rests: list[Tensor] = shaped([shape for stage in shapes for shape in stage[1:]], rest)
        self.layers = [[w1, *rests[3 * number : 3 * number + 3]] for number, w1 in enumerate(firsts)]

    def weight_bits(self) -> Tensor:
        """About what weights that train cost: each matrix under the Laplacian of its own mean magnitude."""
        total = torch.zeros(())
        if not self.leaves:
            return total
        for w1, _, w2, _ in self.layers:
            for matrix in (w1, w2):
                total = total + bits_by_mean(matrix.abs() * 2.0**WEIGHT_SHIFT)
        return total

    def forward(self, stage: int, inputs: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Means in base steps [n, U], scales [n, U] and refinements [n, G] in octaves, from inputs in units of 2^-6."""
        w1, b1, w2, b2 = self.layers[stage]
        x = inputs.clamp(-INPUT_LIMIT, INPUT_LIMIT) * 2.0**-INPUT_BITS
        out = torch.addmm(b2, torch.relu(x @ w1.T + b1), w2.T)
        units = sum(output_count(self.spec, group) for group in self.spec.context.steps[stage])
        return out[:, :units], out[:, units : 2 * units], out[:, 2 * units :]

    def hash_features(self, entries: Tensor, weight: Tensor) -> Tensor:
        """H(x_a) of all seeds by bilinear interpolation of ±1 features [N, L·F], input units (paper, equation 9)."""
        levels = zip(map(binarize, self.tables), entries, weight, strict=True)
        mixed = [(table[entry] * share[..., None]).sum(1) for table, entry, share in levels]  # of [N, 4, F]
        return torch.cat(mixed, dim=1) * 2.0 ** (INPUT_BITS - 12)

    def hash_bits(self) -> Tensor:
        """L_hash: the entropy of the grid's signs (paper, equation 12)."""
        total = torch.zeros(())
        for table in self.tables:
            share = (binarize(table) * 0.5 + 0.5).mean().clamp(1e-6, 1 - 1e-6)
            total = total - table.numel() * (share * share.log2() + (1 - share) * (1 - share).log2())
        return total
