"""The base layer's search against sums over the whole picture and the whole layer, move by move."""

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec._native import search_base
from sgicodec.bitstream.entropy.tables import frequency_tables
from sgicodec.bitstream.parts.arrays import base_errors
from sgicodec.model.base import cubic_weights

I64, I32 = NDArray[np.int64], NDArray[np.int32]

CELL, STEP = 8, 0.02


def bits_of(planes: I64, tables: I32) -> float:
    """Of planes [C, h, w], each coded with its table."""
    errors = zip(base_errors(planes), tables, strict=True)
    return float(sum(frequency_tables().bits(plane, table).sum() for plane, table in errors))


@pytest.mark.parametrize("count", [1, 4])
def test_no_move_of_one_step_is_left_that_pays(count: int) -> None:
    rng, lmbda = np.random.default_rng(count), 0.003
    height, width = 35, 50
    down = cubic_weights(np.arange(height) + 0.5, 5, CELL)
    across = cubic_weights(np.arange(width) + 0.5, 7, CELL)
    target = rng.normal(0, 0.05, (count, height, width))
    planes = np.rint(rng.normal(0, 3, (count, 5, 7)).cumsum(1)).astype(np.int64)
    tables = frequency_tables()
    chosen = np.array([tables.best(errors) for errors in base_errors(planes)], np.int32)

    def cost(values: I64) -> float:
        error = target - STEP * (down @ values @ across.T)
        return float(np.sum(error**2)) + lmbda * bits_of(values, chosen)

    before = cost(planes)
    pull = np.ascontiguousarray(down.T @ (target - STEP * (down @ planes @ across.T)) @ across)
    moves = search_base(
        planes,
        chosen,
        tables.support,
        tables.start,
        tables.symbol_bits,
        down.T @ down,
        across.T @ across,
        pull,
        STEP,
        lmbda,
        60,
    )
    assert moves > planes.size
    after = cost(planes)
    assert after < 0.9 * before
    left = down.T @ (target - STEP * (down @ planes @ across.T)) @ across
    np.testing.assert_allclose(pull, left, atol=1e-9)
    for place in np.ndindex(*planes.shape):
        for by in (-1, 1):
            moved = planes.copy()
            moved[place] += by
            assert cost(moved) > after - 1e-9
