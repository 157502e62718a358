"""Which seeds to add where error stays: the set of quadtree cells whose mean residual is worth the most."""

from __future__ import annotations

import numpy as np

from sgicodec.arrays import F32, Mask
from sgicodec.model.layout import ROOT_LOG, CellSums, SeedLayout


def worthwhile_cells(sums: CellSums, layout: SeedLayout, price: float) -> tuple[SeedLayout, F32]:
    """New seeds for a residual with these sums, of which squares are not looked at, and the residual's mean in each
    one's cell [n, C].

    A Gaussian in a cell of n pixels with mean residual m can remove up to n·|m|² of squared error, or |Σ w r|² / Σ w
    with weights w; its Lagrangian gain is that less `price`. Among a cell and its descendants the better of "one
    here" and "the best below" is taken, as in choosing a best basis, so that no two new seeds overlap. Cells that
    already hold a seed take no second one; cells beside the picture, where there is no residual, take none.
    """
    taken = _occupied(layout, {level: values.shape[1:] for level, values in sums.values.items()})
    gain = {level: np.where(taken[level], 0.0, sums.held(level)) - price for level in range(1, ROOT_LOG + 1)}
    best, here = {1: np.maximum(gain[1], 0)}, {1: gain[1] > 0}
    for level in range(2, ROOT_LOG + 1):
        below = best[level - 1]
        below = below[::2, ::2] + below[1::2, ::2] + below[::2, 1::2] + below[1::2, 1::2]
        here[level] = gain[level] > below
        best[level] = np.maximum(gain[level], below)
    corners, sizes, means = [], [], []
    free: Mask = np.ones_like(here[ROOT_LOG])
    for level in range(ROOT_LOG, 0, -1):
        y, x = np.nonzero(free & here[level])
        corners.append(np.stack([x, y], axis=1).astype(np.int32) << level)
        sizes.append(np.full(len(x), level, np.int8))
        means.append((sums.values[level][:, y, x] / sums.weights[level][y, x]).T.astype(np.float32))
        free = (free & ~here[level]).repeat(2, axis=0).repeat(2, axis=1)
    return SeedLayout(np.concatenate(corners), np.concatenate(sizes)), np.concatenate(means)


def _occupied(layout: SeedLayout, shapes: dict[int, tuple[int, ...]]) -> dict[int, Mask]:
    result = {level: np.zeros(shape, bool) for level, shape in shapes.items()}
    for level, mask in result.items():
        cells = layout.corner[layout.log_size == level] >> level
        mask[cells[:, 1], cells[:, 0]] = True
    return result
