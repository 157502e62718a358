"""Weights of squared error that are less where the picture is busy, where the eye hardly sees it (visual masking)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32
from sgicodec.metrics.local_variance import local_variance


def masking_weights(luma: NDArray[np.float64], empty: NDArray[np.bool_] | None = None) -> F32:
    """w = ((σ² + 10⁻³) / 0.0025)^−¼ of each pixel [H, W], with σ² the variance of luma [H, W], 0 to 255, in the window
    of 11×11 pixels around it, in samples of 0 to 1.

    Windows end where the picture or tile ends: a tile that overlaps its neighbours by 5 pixels or more has the weights
    of the whole picture wherever it alone is shown. Pixels that need not be shown, `empty` [H, W], weigh as little as
    the busiest pixel could.
    """
    variance = local_variance(luma / 255.0)
    if empty is not None:
        variance[empty] = _MAX_VARIANCE
    return np.asarray(((variance + _FLOOR) / _USUAL) ** _POWER, np.float32)


_FLOOR = 1e-3
"""Variance below which pixels count as flat, samples²: a standard deviation of 8 levels of 255."""
_MAX_VARIANCE = 0.25
"""Of samples in 0..1: half of them 0, half 1."""
_USUAL, _POWER = 0.0025, -0.25
"""The variance, floor included, where an error counts 1, and the power: the mean weight of 26 photographs is 0.89, from
0.65 to 1.13, so that λ and quality keep their meaning. Texture shows what is busy, so that the power is half of what
serves seeds that are alone (docs/notes/2026-11-seeds-for-the-eye.md).
"""
