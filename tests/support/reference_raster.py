"""A reference of the rasteriser: a dense sum in float64, slow and simple, with which every back end is compared."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.raster.backend import Errors, Loss

F64 = NDArray[np.float64]


class ReferenceRasterizer:
    """The dense sum as a back end, but for samples. Takes memory for N · height · width numbers several times over."""

    def forward(
        self, means: F64, covariances: F64, colours: F64, width: int, height: int, origin: tuple[int, int] = (0, 0)
    ) -> F64:
        """See `rasterize_reference`."""
        return rasterize_reference(means, covariances, colours, width, height, origin)

    def error(
        self,
        means: F64,
        covariances: F64,
        colours: F64,
        target: F64,
        loss: Loss = "squared",
        weight: float = 1.0,
        weights: F64 | None = None,
        origin: tuple[int, int] = (0, 0),
    ) -> tuple[Errors, tuple[F64, F64, F64]]:
        """As in `Backend`."""
        _, height, width = target.shape
        error = rasterize_reference(means, covariances, colours, width, height, origin) - target
        size, slope = (error * error, 2 * error) if loss == "squared" else (np.abs(error), np.sign(error))
        by_pixel = weight if weights is None else weight * weights
        grads = rasterize_reference_backward(means, covariances, colours, by_pixel * slope, origin)
        return Errors(float(np.sum(by_pixel * size)), float(np.sum(error * error))), grads


def rasterize_reference(
    means: F64, covariances: F64, colours: F64, width: int, height: int, origin: tuple[int, int] = (0, 0)
) -> F64:
    """I(x) = Σ_i c_i exp(−½ dᵀ Σ_i⁻¹ d) at pixel centres (paper, equations 4 and 5), without any cutoff.

    means [N, 2] pixels, covariances [N, 3] (xx, xy, yy) pixels², colours [N, C] → image [C, height, width] of the
    crop whose first pixel is `origin`. What is not finite or not positive definite is left out.
    """
    drawn = _drawable(means, covariances)
    weights, _, _ = _densities(means[drawn], covariances[drawn], width, height, origin)
    return np.asarray(np.einsum("nc,nyx->cyx", colours[drawn], weights))


def rasterize_reference_backward(
    means: F64, covariances: F64, colours: F64, grad: F64, origin: tuple[int, int] = (0, 0)
) -> tuple[F64, F64, F64]:
    """Gradients (means [N, 2], covariances [N, 3], colours [N, C]) from dL/dI = grad [C, H, W]."""
    _, height, width = grad.shape
    drawn = _drawable(means, covariances)
    weights, delta, inverse = _densities(means[drawn], covariances[drawn], width, height, origin)
    grad_means, grad_covariances, grad_colours = (np.zeros(a.shape) for a in (means, covariances, colours))
    grad_colours[drawn] = np.einsum("cyx,nyx->nc", grad, weights)
    w = np.einsum("nc,cyx,nyx->nyx", colours[drawn], grad, weights, optimize=True)
    solved = np.einsum("nij,njyx->niyx", inverse, delta)  # Σ⁻¹ d
    grad_means[drawn] = np.einsum("nyx,niyx->ni", w, solved)
    full = 0.5 * np.einsum("nyx,niyx,njyx->nij", w, solved, solved, optimize=True)
    grad_covariances[drawn] = np.stack([full[:, 0, 0], 2 * full[:, 0, 1], full[:, 1, 1]], axis=1)
    return grad_means, grad_covariances, grad_colours


def _drawable(means: F64, covariances: F64) -> NDArray[np.bool_]:
    """Which Gaussians have finite means and finite covariances that are positive definite by a margin [N]."""
    finite: NDArray[np.bool_] = np.isfinite(np.concatenate([means, covariances], axis=1)).all(axis=1)
    xx, xy, yy = np.where(finite.reshape(-1, 1), covariances, 0.0).T
    definite: NDArray[np.bool_] = (xx > 0) & (yy > 0) & (xx * yy - xy * xy > 1e-12 * xx * yy)
    return definite


def _densities(means: F64, covariances: F64, width: int, height: int, origin: tuple[int, int]) -> tuple[F64, F64, F64]:
    """Values [N, H, W], offsets from the centres [N, 2, H, W], inverse covariances [N, 2, 2]."""
    x = np.arange(width) + origin[0] + 0.5
    y = np.arange(height) + origin[1] + 0.5
    delta = np.empty((len(means), 2, height, width))
    delta[:, 0] = (x - means[:, :1])[:, None, :]
    delta[:, 1] = (y - means[:, 1:])[:, :, None]
    inverse: F64 = np.linalg.inv(covariances[:, [0, 1, 1, 2]].reshape(-1, 2, 2)).astype(np.float64)
    exponent = -0.5 * np.einsum("niyx,nij,njyx->nyx", delta, inverse, delta, optimize=True)
    return np.exp(exponent), delta, inverse
