"""Where seeds are added, against all sets of cells of a small quadtree, one by one."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec.fit.densification import worthwhile_cells
from sgicodec.model.layout import ROOT_LOG, SeedLayout, cell_sums

F64 = NDArray[np.float64]

NONE = SeedLayout(np.zeros((0, 2), np.int32), np.zeros(0, np.int8))
SIDE = 64


def best_gain(gains: dict[int, F64], level: int, row: int, column: int) -> float:
    """The most that cells within a cell can gain, none of them within another."""
    if level not in gains:
        return 0.0
    below = sum(best_gain(gains, level - 1, 2 * row + i, 2 * column + j) for i, j in product((0, 1), repeat=2))
    return max(float(gains[level][row, column]), below, 0.0)


@pytest.mark.parametrize("weighted", [False, True])
def test_the_cells_gain_the_most(weighted: bool) -> None:
    rng = np.random.default_rng(1)
    residual = rng.normal(size=(2, SIDE, SIDE)).astype(np.float32)
    weights = np.asarray(rng.uniform(0.1, 3.0, (SIDE, SIDE)), np.float32) if weighted else None
    w, price = np.ones((SIDE, SIDE)) if weights is None else weights.astype(np.float64), 3.0
    gains = {}
    for level in range(1, 7):
        cells = (SIDE >> level, 1 << level) * 2
        sums = (w * residual).reshape(2, *cells).sum(axis=(2, 4))
        gains[level] = (sums**2).sum(0) / w.reshape(cells).sum(axis=(1, 3)) - price
    added, means = worthwhile_cells(cell_sums(residual, ROOT_LOG, weights), NONE, price)
    total = 0.0
    for (x, y), k, mean in zip(added.corner, added.log_size, means, strict=True):
        total += gains[k][y >> k, x >> k]
        part = np.s_[y : y + (1 << k), x : x + (1 << k)]
        expected = (w[part] * residual[:, *part]).sum(axis=(1, 2)) / w[part].sum()
        np.testing.assert_allclose(mean, expected, atol=1e-6)
    assert len(added) > 10
    assert total == pytest.approx(best_gain(gains, 6, 0, 0))


def test_no_seed_lies_beside_the_picture() -> None:
    """Where there is no error to be removed, for no price either."""
    residual = np.random.default_rng(3).normal(size=(1, 70, 30)).astype(np.float32)
    for price in (0.0, 2.0):
        added, _ = worthwhile_cells(cell_sums(residual, ROOT_LOG), NONE, price)
        assert len(added) > 5
        assert (added.corner < (30, 70)).all()
