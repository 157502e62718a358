"""Morton order: two coordinates as one integer whose bits alternate between them.

The children of quadtree node n are nodes 4n … 4n + 3 of the next level, so a tree needs no other address.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.int64]


def canonical_order(corner: NDArray[np.integer], log_size: NDArray[np.integer]) -> NDArray[np.intp]:
    """Indices that sort seeds by the Morton order of corners [N, 2], coarse before fine at equal corners."""
    return np.lexsort((-log_size.astype(np.int64), morton(corner[:, 0], corner[:, 1])))


def morton(x: NDArray[np.integer], y: NDArray[np.integer]) -> Codes:
    """Interleaved bits of 0 ≤ x, y < 2**31, those of x at the even places."""
    return _spread(x) | _spread(y) << 1


_STAGES = (
    (16, 0x0000FFFF0000FFFF),
    (8, 0x00FF00FF00FF00FF),
    (4, 0x0F0F0F0F0F0F0F0F),
    (2, 0x3333333333333333),
    (1, 0x5555555555555555),
)
"""Shifts and masks that move the bits of a 32-bit integer to the even places of a 64-bit one."""


def _spread(v: NDArray[np.integer]) -> Codes:
    code: Codes = v.astype(np.int64)
    for shift, mask in _STAGES:
        code = (code | code << shift) & mask
    return code
