"""The protocol of a rasteriser's back end. Everything special to a device stays behind it."""

from __future__ import annotations

from typing import Literal, NamedTuple, Protocol

from sgicodec.arrays import F32

DEFAULT_CUTOFF = 3.5
"""Standard deviations after which a Gaussian is not drawn: exp(−3.5²/2) = 0.0022 of its amplitude."""

Loss = Literal["squared", "absolute"]


class Errors(NamedTuple):
    """What a rendered picture's errors sum to: by the loss that was asked for, and their squares without weights."""

    loss: float
    squared: float


class Backend(Protocol):
    """Draws I(x) = Σ_i c_i exp(−½ dᵀ Σ_i⁻¹ d), d = x − μ_i, at pixel centres (j + ½, i + ½), and differentiates it.

    Means [N, 2] and covariances [N, 3] (xx, xy, yy) are in pixels and pixels², colours [N, C]; images are
    [C, height, width] and show the crop whose first pixel is `origin` (x, y). A Gaussian that is not finite or not
    positive definite is not rendered and has zero gradients.
    """

    def forward(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        width: int,
        height: int,
        origin: tuple[int, int] = (0, 0),
    ) -> F32:
        """The image."""
        ...

    def error(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        target: F32,
        loss: Loss = "squared",
        weight: float = 1.0,
        weights: F32 | None = None,
        origin: tuple[int, int] = (0, 0),
    ) -> tuple[Errors, tuple[F32, F32, F32]]:
        """weight · Σ w (I − target)², or |I − target|, with weights w [H, W] of the pixels, by default 1, and its
        gradients; those of a size are 0 where I is the target.
        """
        ...
