"""The protocol of a rasteriser's back end. Everything special to a device stays behind it."""

from __future__ import annotations

from typing import Protocol, TypeVar

__all__ = ["DEFAULT_CUTOFF", "Backend"]

DEFAULT_CUTOFF = 3.5
"""Standard deviations after which a Gaussian is not drawn: exp(−3.5²/2) = 0.0022 of its amplitude."""

Array = TypeVar("Array")


class Backend(Protocol[Array]):
    """Draws I(x) = Σ_i c_i exp(−½ dᵀ Σ_i⁻¹ d), d = x − μ_i, at pixel centres (j + ½, i + ½), and differentiates it.

    `Array` is what the device computes on. Means [N, 2] and covariances [N, 3] (xx, xy, yy) are in pixels and pixels²,
    colours [N, C]; images are [C, height, width] and show the crop whose first pixel is `origin` (x, y). A Gaussian
    that is not finite or not positive definite is not drawn and has zero gradients.
    """

    def forward(
        self,
        means: Array,
        covariances: Array,
        colours: Array,
        width: int,
        height: int,
        origin: tuple[int, int] = (0, 0),
    ) -> Array:
        """The image."""
        ...

    def backward(
        self, means: Array, covariances: Array, colours: Array, grad: Array, origin: tuple[int, int] = (0, 0)
    ) -> tuple[Array, Array, Array]:
        """Gradients of means, covariances and colours from dL/dI = grad, right after `forward` on the same."""
        ...

    def squared_error(
        self,
        means: Array,
        covariances: Array,
        colours: Array,
        target: Array,
        weight: float,
        origin: tuple[int, int] = (0, 0),
    ) -> tuple[float, tuple[Array, Array, Array]]:
        """weight · Σ (I − target)² and its gradients."""
        ...

    def weighted_squared_error(
        self,
        means: Array,
        covariances: Array,
        colours: Array,
        target: Array,
        weights: Array,
        origin: tuple[int, int] = (0, 0),
    ) -> tuple[tuple[float, float], tuple[Array, Array, Array]]:
        """Σ w (I − target)² with weights [H, W], Σ (I − target)², and the gradients of the former."""
        ...
