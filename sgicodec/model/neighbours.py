"""Nearest seeds, in exact integer arithmetic so that both sides of a stream agree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import nearest_among, nearest_neighbours

__all__ = ["nearest_points", "nearest_seeds"]


def nearest_points(points: NDArray[np.int32], queries: NDArray[np.int32], k: int) -> NDArray[np.int32]:
    """Indices [m, k] of the k nearest of `points` [n, 2] for each of `queries` [m, 2], nearest first, ties to the lower
    index; −1 where there are fewer than k points.
    """
    out = np.empty((len(queries), k), np.int32)
    nearest_neighbours(np.ascontiguousarray(points), np.ascontiguousarray(queries), out, 1)
    return out


def nearest_seeds(
    points: NDArray[np.int32], among: NDArray[np.int64], members: NDArray[np.int64], k: int
) -> NDArray[np.int32]:
    """The same for seeds at `points` [N, 2]: of the seeds `members` [m] their k nearest among the seeds `among` [n],
    ascending. All in one call, which lets other threads run.
    """
    out = np.empty((len(members), k), np.int32)
    nearest_among(np.ascontiguousarray(points), among, members, out, 1)
    return out
