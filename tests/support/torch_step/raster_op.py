"""The rasteriser's comparison with a picture as a torch operation."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec.raster.backend import Backend, Loss

__all__ = ["error"]

F32 = NDArray[np.float32]


class _Error(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any,
        means: Tensor,
        covariances: Tensor,
        colours: Tensor,
        target: Tensor,
        raster: Backend[F32],
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
    raster: Backend[F32],
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
