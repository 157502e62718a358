"""The rasteriser as torch operations."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec.raster.backend import Backend

__all__ = ["absolute_error", "rasterize", "squared_error"]

F32 = NDArray[np.float32]


class _Rasterize(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any,
        means: Tensor,
        covariances: Tensor,
        colours: Tensor,
        size: tuple[int, int],
        raster: Backend[F32],
    ) -> Tensor:
        arrays = _arrays(means, covariances, colours)
        ctx.arrays, ctx.raster = arrays, raster
        return torch.from_numpy(raster.forward(*arrays, size[0], size[1]))

    @staticmethod
    def backward(ctx: Any, *grads: Tensor) -> tuple[Tensor | None, ...]:
        out = ctx.raster.backward(*ctx.arrays, grads[0].contiguous().numpy())
        return (*(torch.from_numpy(g) for g in out), None, None)


class _SquaredError(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any,
        means: Tensor,
        covariances: Tensor,
        colours: Tensor,
        target: Tensor,
        raster: Backend[F32],
    ) -> Tensor:
        loss, ctx.grads = raster.squared_error(*_arrays(means, covariances, colours), target.numpy(), 1.0)
        return torch.tensor(loss)

    @staticmethod
    def backward(ctx: Any, *grads: Tensor) -> tuple[Tensor | None, ...]:
        return (*(torch.from_numpy(g) * grads[0] for g in ctx.grads), None, None)


class _AbsoluteError(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any,
        means: Tensor,
        covariances: Tensor,
        colours: Tensor,
        target: Tensor,
        raster: Backend[F32],
    ) -> tuple[Tensor, Tensor]:
        arrays, weight = _arrays(means, covariances, colours), 1.0 / target.numel()
        (loss, squared), ctx.grads = raster.absolute_error(*arrays, target.numpy(), weight)
        sum_of_squares = torch.tensor(squared, dtype=torch.float64)
        ctx.mark_non_differentiable(sum_of_squares)
        return torch.tensor(loss), sum_of_squares

    @staticmethod
    def backward(ctx: Any, *grads: Tensor) -> tuple[Tensor | None, ...]:
        return (*(torch.from_numpy(g) * grads[0] for g in ctx.grads), None, None)


def rasterize(
    means: Tensor, covariances: Tensor, colours: Tensor, size: tuple[int, int], raster: Backend[F32]
) -> Tensor:
    """Image [C, H, W] of size (W, H), differentiable in means [N, 2], covariances [N, 3] and colours [N, C].

    `raster` keeps the forward pass's tile lists: run the backward pass before its next forward.
    """
    return cast(Tensor, _Rasterize.apply(means, covariances, colours, size, raster))  # type: ignore[no-untyped-call]


def squared_error(means: Tensor, covariances: Tensor, colours: Tensor, target: Tensor, raster: Backend[F32]) -> Tensor:
    """Σ (I − target)² over target [C, H, W] in one pass over the tiles, differentiable in the Gaussians."""
    return cast(Tensor, _SquaredError.apply(means, covariances, colours, target, raster))  # type: ignore[no-untyped-call]


def absolute_error(
    means: Tensor, covariances: Tensor, colours: Tensor, target: Tensor, raster: Backend[F32]
) -> tuple[Tensor, float]:
    """L1, the mean of |I − target| over target [C, H, W], differentiable in the Gaussians, and Σ (I − target)²."""
    loss, squared = _AbsoluteError.apply(means, covariances, colours, target, raster)  # type: ignore[no-untyped-call]
    return cast(Tensor, loss), float(squared)


def _arrays(means: Tensor, covariances: Tensor, colours: Tensor) -> tuple[F32, F32, F32]:
    first, second, third = (t.detach().contiguous().numpy() for t in (means, covariances, colours))
    return first, second, third
