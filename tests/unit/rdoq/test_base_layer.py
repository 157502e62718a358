"""The base layer's search against sums over the whole picture and the whole layer, move by move."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec._native import search_base
from sgicodec.bitstream.entropy.tables import frequency_tables
from sgicodec.bitstream.parts.arrays import PREDICTORS, BaseChannel, base_channels, base_references
from sgicodec.model.base import cubic_weights

I64 = NDArray[np.int64]

CELL, STEP = 8, 0.02


def bits_of(planes: I64, channels: list[BaseChannel]) -> float:
    """Of planes [C, h, w] coded as `channels` say."""
    bits, errors = 0.0, []
    for number, (plane, channel) in enumerate(zip(planes, channels, strict=True)):
        padded = np.zeros((plane.shape[0] + 1, plane.shape[1] + 1), np.int64)
        padded[1:, 1:] = plane
        padded[0, 2:], padded[2:, 0] = plane[0, :-1], plane[:-1, 0]
        predicted = PREDICTORS[channel.predictor](padded[1:, :-1], padded[:-1, 1:], padded[:-1, :-1])
        errors.append(plane - predicted)
        mixed = sum(w * errors[r] for w, r in zip(channel.weights, base_references(number), strict=True))
        bits += frequency_tables().bits(errors[-1] - (mixed + 4 >> 3), channel.table).sum()
    return bits


@pytest.mark.parametrize("predictor", range(4))
@pytest.mark.parametrize("count", [1, 4])
def test_no_move_of_one_step_is_left_that_pays(count: int, predictor: int) -> None:
    rng, lmbda = np.random.default_rng(count), 0.003
    height, width = 35, 50
    down = cubic_weights(np.arange(height) + 0.5, 5, CELL)
    across = cubic_weights(np.arange(width) + 0.5, 7, CELL)
    target = rng.normal(0, 0.05, (count, height, width))
    planes = np.rint(rng.normal(0, 3, (count, 5, 7)).cumsum(1)).astype(np.int64)
    channels = [replace(channel, predictor=predictor) for channel in base_channels(planes)]
    if count > 1:
        channels = [replace(channel, weights=[3, -2][: len(channel.weights)]) for channel in channels]
    weights = np.zeros((count, count), np.int32)
    for number, channel in enumerate(channels):
        weights[number, base_references(number)] = channel.weights

    def cost(values: I64) -> float:
        error = target - STEP * (down @ values @ across.T)
        return float(np.sum(error**2)) + lmbda * bits_of(values, channels)

    before = cost(planes)
    pull = np.ascontiguousarray(down.T @ (target - STEP * (down @ planes @ across.T)) @ across)
    tables = frequency_tables()
    moves = search_base(
        planes,
        np.full(count, predictor, np.int32),
        weights,
        np.array([channel.table for channel in channels], np.int32),
        tables.support,
        tables.start,
        tables.symbol_bits,
        down.T @ down,
        across.T @ across,
        None,
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
