"""Nearest seeds, in exact integer arithmetic so that both sides of a stream agree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import nearest_neighbours

__all__ = ["nearest_seeds"]


def nearest_seeds(points: NDArray[np.int32], queries: NDArray[np.int32], k: int, threads: int = 1) -> NDArray[np.int32]:
    """Indices [m, k] of the k nearest of `points` [n, 2] for each of `queries` [m, 2], nearest first, ties to the lower
    index; −1 where there are fewer than k points.
    """
    out = np.empty((len(queries), k), np.int32)
    nearest_neighbours(np.ascontiguousarray(points), np.ascontiguousarray(queries), out, threads)
    return out
