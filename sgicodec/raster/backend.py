"""The protocol of a rasteriser's back end. Everything special to a device stays behind it."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["DEFAULT_CUTOFF", "Backend", "Background", "Errors", "Loss", "Mapping", "nothing_behind"]

F32 = NDArray[np.float32]

DEFAULT_CUTOFF = 3.5
"""Standard deviations after which a Gaussian is not drawn: exp(−3.5²/2) = 0.0022 of its amplitude."""

Array = TypeVar("Array")


Loss = Literal["squared", "absolute"]


class Errors(NamedTuple):
    """What a rendered picture's errors sum to: by the loss that was asked for, and their squares without weights."""

    loss: float
    squared: float


class Background(NamedTuple):
    """What is behind the Gaussians: row i is the sum over t of down[i, t] · lines[:, top[i] + t], and of `planes`.

    lines [C, L, width], top [height], down [height, T], empty for no lines; planes [C, height, width] or None.
    """

    lines: F32
    top: NDArray[np.int32]
    down: F32
    planes: F32 | None = None


def nothing_behind(channels: int, planes: F32 | None = None) -> Background:
    """A background without lines."""
    lines = np.zeros((channels, 0, 0), np.float32), np.zeros(0, np.int32), np.zeros((0, 0), np.float32)
    return Background(*lines, planes)


class Mapping(NamedTuple):
    """The sample low + span · v that stands for a value v, clipped to 0 … 1, by channel [C]."""

    low: F32
    span: F32


class Backend(Protocol[Array]):
    """Draws I(x) = Σ_i c_i exp(−½ dᵀ Σ_i⁻¹ d), d = x − μ_i, at pixel centres (j + ½, i + ½), and differentiates it.

    `Array` is what the device computes on. Means [N, 2] and covariances [N, 3] (xx, xy, yy) are in pixels and pixels²,
    colours [N, C]; images are [C, height, width] and show the crop whose first pixel is `origin` (x, y). A Gaussian
    that is not finite or not positive definite is not rendered and has zero gradients.
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

    def draw(
        self,
        means: Array,
        covariances: Array,
        colours: Array,
        out: NDArray[Any],
        origin: tuple[int, int] = (0, 0),
        background: Background | None = None,
        mapping: Mapping | None = None,
    ) -> None:
        """Draws onto `background` and stores samples in out [height, width, C], uint8, uint16 or float32: with a
        `mapping` those that it maps to, without one the values as they are, in float32.
        """
        ...

    def error(
        self,
        means: Array,
        covariances: Array,
        colours: Array,
        target: Array,
        loss: Loss = "squared",
        weight: float = 1.0,
        weights: Array | None = None,
        origin: tuple[int, int] = (0, 0),
    ) -> tuple[Errors, tuple[Array, Array, Array]]:
        """weight · Σ w (I − target)², or |I − target|, with weights w [H, W] of the pixels, by default 1, and its
        gradients; those of a size are 0 where I is the target.
        """
        ...
