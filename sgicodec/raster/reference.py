"""The rasteriser as a float64 dense sum: slow, obvious, the yardstick of every back end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["rasterize_reference", "rasterize_reference_backward"]

F64 = NDArray[np.float64]


def rasterize_reference(
    means: F64, covariances: F64, colours: F64, width: int, height: int, origin: tuple[int, int] = (0, 0)
) -> F64:
    """I(x) = Σ_i c_i exp(−½ dᵀ Σ_i⁻¹ d) at pixel centres (paper, equations 4 and 5), without any cutoff.

    means [N, 2] pixels, covariances [N, 3] (xx, xy, yy) pixels², colours [N, C] → image [C, height, width] of the
    crop whose first pixel is `origin`.
    """
    weights, _, _ = _densities(means, covariances, width, height, origin)
    return np.einsum("nc,nyx->cyx", colours, weights)


def rasterize_reference_backward(
    means: F64, covariances: F64, colours: F64, grad: F64, origin: tuple[int, int] = (0, 0)
) -> tuple[F64, F64, F64]:
    """Gradients (means [N, 2], covariances [N, 3], colours [N, C]) from dL/dI = grad [C, H, W]."""
    _, height, width = grad.shape
    weights, delta, inverse = _densities(means, covariances, width, height, origin)
    grad_colours = np.einsum("cyx,nyx->nc", grad, weights)
    w = np.einsum("nc,cyx,nyx->nyx", colours, grad, weights)
    solved = np.einsum("nij,njyx->niyx", inverse, delta)  # Σ⁻¹ d
    grad_means = np.einsum("nyx,niyx->ni", w, solved)
    full = 0.5 * np.einsum("nyx,niyx,njyx->nij", w, solved, solved)
    grad_covariances = np.stack([full[:, 0, 0], 2 * full[:, 0, 1], full[:, 1, 1]], axis=1)
    return grad_means, grad_covariances, grad_colours


def _densities(means: F64, covariances: F64, width: int, height: int, origin: tuple[int, int]) -> tuple[F64, F64, F64]:
    x = np.arange(width) + origin[0] + 0.5
    y = np.arange(height) + origin[1] + 0.5
    dx = np.broadcast_to((x[None, :] - means[:, :1])[:, None, :], (len(means), height, width))
    dy = np.broadcast_to((y[None, :] - means[:, 1:])[:, :, None], (len(means), height, width))
    delta = np.stack([dx, dy], axis=1)  # [N, 2, H, W]
    matrix = covariances[:, [0, 1, 1, 2]].reshape(-1, 2, 2)
    inverse = np.linalg.inv(matrix)
    exponent = -0.5 * np.einsum("niyx,nij,njyx->nyx", delta, inverse, delta)
    return np.exp(exponent), delta, inverse
