"""Variance of a plane around each pixel."""

from __future__ import annotations

import numpy as np

from sgicodec import _native
from sgicodec.arrays import F64

_RADIUS = 5
"""Pixels from a window's centre to its border."""


def local_variance(plane: F64) -> F64:
    """Variance [H, W] in the window of 11×11 pixels around each pixel, as far as it lies in the plane."""
    found = np.empty_like(plane, np.float64, order="C")
    _native.local_variance(np.ascontiguousarray(plane, np.float64), _RADIUS, found)
    return found
