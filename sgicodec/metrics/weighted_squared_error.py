"""Squared error that counts less where the picture is busy, where the eye hardly sees it (visual masking)."""

from __future__ import annotations

import numpy as np

from sgicodec.metrics.distortion import F32, Mask, QuadraticReference
from sgicodec.metrics.local_variance import local_variance
from sgicodec.metrics.psnr import luma

__all__ = ["WeightedSquaredError"]


class WeightedSquaredError:
    """Σ w e², w = ((σ² + 10⁻³) / 0.0025)^−¼, with σ² the variance of luma in the window of 11×11 pixels around a
    pixel.

    Windows end where the picture or tile ends: a tile that overlaps its neighbours by 5 pixels or more has the weights
    of the whole picture wherever it alone is shown. Empty pixels weigh as little as the busiest pixel could.
    """

    name = "weighted"

    def reference(self, picture: F32, empty: Mask | None = None) -> QuadraticReference:
        """See `Distortion.reference`."""
        variance = local_variance(luma(picture.transpose(1, 2, 0), peak=1.0) / 255.0)
        if empty is not None:
            variance[empty] = _MAX_VARIANCE
        return QuadraticReference(np.asarray(((variance + _FLOOR) / _USUAL) ** _POWER, np.float32))


_FLOOR = 1e-3
"""Variance below which pixels count as flat, samples²: a standard deviation of 8 levels of 255."""
_MAX_VARIANCE = 0.25
"""Of samples in 0..1: half of them 0, half 1."""
_USUAL, _POWER = 0.0025, -0.25
"""The variance, floor included, where an error counts 1, and the power: the mean weight of 26 photographs is 0.89, from
0.65 to 1.13. Texture shows what is busy, so that the power is half of what serves seeds that are alone
(docs/notes/2026-11-seeds-for-the-eye.md).
"""
