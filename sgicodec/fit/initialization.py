"""Where a fit starts: attributes of seeds that have seen nothing yet, and weights of the decoders."""

from __future__ import annotations

import math

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec

__all__ = ["cell_means", "fresh_decoders", "fresh_values"]

F32 = NDArray[np.float32]


def fresh_values(
    spec: ModelSpec, mean: Tensor, opponent: Tensor, pixels: int, generator: torch.Generator
) -> dict[str, Tensor]:
    """Attributes by group [n, size] of seeds whose cells hold `mean` [n, C] of a picture of so many pixels.

    With the skip a seed starts as a round Gaussian of half its cell and most of its cell's mean colour; without it, at
    f = 0 as published, with scales that cover the picture. K > 1 Gaussians start apart.
    """
    n = len(mean)
    values = {group.name: torch.zeros(n, group.size) for group in spec.groups}
    if spec.skip:
        values["colour"] = (0.7 * mean @ opponent.T).repeat(1, spec.per_seed) / spec.per_seed
        values["shape"][:, 0::3] = math.log(0.5)
    if spec.seed_scales:
        values["scales"] += math.log(0.5 * math.sqrt(pixels / n))
    if spec.per_seed > 1:
        spread = 0.35 if spec.skip else 0.7
        values["offset"] += spread * torch.randn(values["offset"].shape, generator=generator)
    return values


def fresh_decoders(spec: ModelSpec, generator: torch.Generator) -> dict[str, Tensor]:
    """Weights of MLP_c and MLP_Σ: Xavier-uniform, zero biases, and nearly nothing out of MLP_c (gain 0.01, as
    published) or, beside a skip, of either.
    """
    decoders = {}
    for name, shape in decoder_shapes(spec).items():
        if len(shape) == 1:
            tensor = torch.zeros(shape)
        else:
            quiet = name.startswith("colour") or spec.skip
            gain = 1.0 if name.endswith("w1") else 0.01 if quiet else 0.5
            bound = gain * math.sqrt(6.0 / (shape[0] + shape[1]))
            tensor = (torch.rand(shape, generator=generator) * 2 - 1) * bound
        decoders[name] = tensor.requires_grad_()
    return decoders


def cell_means(target: F32, layout: SeedLayout) -> F32:
    """Mean of `target` [C, H, W] over each seed's cell, as far as it lies in the picture [N, C]."""
    channels, height, width = target.shape
    table = np.zeros((channels, height + 1, width + 1))
    table[:, 1:, 1:] = target.astype(np.float64).cumsum(1).cumsum(2)
    x0, y0 = layout.corner[:, 0], layout.corner[:, 1]
    side = layout.cell.astype(np.int64)
    x1, y1 = np.minimum(x0 + side, width), np.minimum(y0 + side, height)
    total = table[:, y1, x1] - table[:, y0, x1] - table[:, y1, x0] + table[:, y0, x0]
    means: F32 = (total / ((x1 - x0) * (y1 - y0))).T.astype(np.float32)
    return means
