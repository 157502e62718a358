"""Nearest seeds, in exact integer arithmetic so that both sides of a stream agree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import nearest_among

__all__ = ["nearest_seeds"]


def nearest_seeds(
    points: NDArray[np.int32], among: NDArray[np.int64], members: NDArray[np.int64], k: int
) -> NDArray[np.int32]:
    """Of seeds at `points` [N, 2], for each of the seeds `members` [m] its k nearest among the seeds `among` [n],
    ascending: indices [m, k], nearest first, ties to the lower index, −1 where there are fewer than k.

    All in one call, which lets other threads run.
    """
    out = np.empty((len(members), k), np.int32)
    nearest_among(np.ascontiguousarray(points), among, members, out, 1, "auto")
    return out
