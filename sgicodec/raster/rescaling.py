"""Gaussians at another scale: in output pixels and, where these are larger, filtered so that nothing aliases."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import PIXEL_VARIANCE

__all__ = ["scaled"]

Float = TypeVar("Float", np.float32, np.float64)


def scaled(
    means: NDArray[Float],
    covariances: NDArray[Float],
    colours: NDArray[Float],
    scale: tuple[float, float],
    start: tuple[float, float] = (0.0, 0.0),
) -> tuple[NDArray[Float], NDArray[Float], NDArray[Float]]:
    """The Gaussians of a picture scaled by (sx, sy) whose point `start` moves to (0, 0).

    means [N, 2], covariances [N, 3] (xx, xy, yy), colours [N, C] in and out, in pixels of the old and the new picture.
    An axis that shrinks is convolved with what its new pixels cover beyond the old ones, a variance of 1 − s² of
    `PIXEL_VARIANCE`; each Gaussian keeps its integral.
    """
    sx, sy = scale
    moved = (means.astype(np.float64) - start) * scale
    shape = covariances.astype(np.float64) * [sx * sx, sx * sy, sy * sy]
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):  # what is not finite is not rendered
        before = shape[:, 0] * shape[:, 2] - shape[:, 1] ** 2
        shape[:, 0] += PIXEL_VARIANCE * max(0.0, 1 - sx * sx)
        shape[:, 2] += PIXEL_VARIANCE * max(0.0, 1 - sy * sy)
        after = shape[:, 0] * shape[:, 2] - shape[:, 1] ** 2
        fade = np.sqrt(np.where(before > 0, before / after, 0.0))
        faded = colours * fade[:, None]
        return moved.astype(means.dtype), shape.astype(covariances.dtype), faded.astype(colours.dtype)
