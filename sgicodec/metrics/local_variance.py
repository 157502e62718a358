"""Variance of a plane around each pixel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["local_variance"]

F64 = NDArray[np.float64]

_RADIUS = 5
"""Pixels from a window's centre to its border."""


def local_variance(plane: F64) -> F64:
    """Variance [H, W] in the window of 11×11 pixels around each pixel, as far as it lies in the plane."""
    mean = _window_means(plane)
    return np.maximum(_window_means(plane * plane) - mean * mean, 0.0)


def _window_means(plane: F64) -> F64:
    for axis in (0, 1):
        plane = _line_means(plane, axis)
    return plane


def _line_means(plane: F64, axis: int) -> F64:
    """Means over the part of 2 · _RADIUS + 1 samples along an axis that lies in the plane."""
    size = plane.shape[axis]
    first = np.maximum(np.arange(size) - _RADIUS, 0)
    last = np.minimum(np.arange(size) + _RADIUS + 1, size)
    before = np.zeros_like(plane, shape=(*plane.shape[:axis], 1, *plane.shape[axis + 1 :]))
    sums = np.concatenate([before, plane.cumsum(axis)], axis)
    counts = (last - first).reshape((-1, 1) if axis == 0 else (1, -1))
    means: F64 = (sums.take(last, axis) - sums.take(first, axis)) / counts
    return means
