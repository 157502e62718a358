"""Regular patterns: stripes are found with their strength and frequency, edges and noise are not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.metrics.regular_pattern import regular_patterns
from tests.support.scenes import ISAS

SHAPE = 96, 128
ROWS, COLUMNS = np.mgrid[: SHAPE[0], : SHAPE[1]]


def stripes(period: float, degrees: float, amplitude: float) -> NDArray[np.float64]:
    turn = np.radians(degrees)
    across = COLUMNS * np.cos(turn) + ROWS * np.sin(turn)
    return np.asarray(amplitude * np.sin(2 * np.pi * across / period))


@pytest.mark.parametrize("degrees", [0, 20, 45, 90, 135])
@pytest.mark.parametrize("period", [2.6, 3.0, 4.0, 6.0])
def test_stripes_are_found(period: float, degrees: float) -> None:
    found = regular_patterns(120 + stripes(period, degrees, 9.0))
    inner = np.s_[2:-2, 2:-2]
    assert found.certainty[inner].min() == 1
    np.testing.assert_allclose(found.deviation[inner], 9 / np.sqrt(2), rtol=0.1)
    np.testing.assert_allclose(found.frequency[inner], 2 / period, rtol=0.15)


@pytest.mark.parametrize("degrees", [0, 20, 45, 90])
def test_one_edge_is_no_pattern(degrees: float) -> None:
    turn = np.radians(degrees)
    edge = (COLUMNS - 64) * np.cos(turn) + (ROWS - 48) * np.sin(turn)
    plane = 60 + 120 / (1 + np.exp(-edge / 0.7))
    assert regular_patterns(plane).certainty.max() == 0


def test_a_block_depends_on_the_pixels_near_it() -> None:
    plane = stripes(4.0, 30, 8.0) + np.random.default_rng(4).normal(0, 4, SHAPE)
    whole, part = regular_patterns(plane), regular_patterns(plane[16:80, 32:112])
    np.testing.assert_allclose(part.certainty[1:-1, 1:-1], whole.certainty[3:9, 5:13], rtol=1e-5)


@pytest.mark.parametrize("isa", ISAS)
def test_instruction_sets_agree(isa: str) -> None:
    plane = 120 + stripes(3.7, 25, 6.0) * (COLUMNS > 60) + np.random.default_rng(5).normal(0, 3, SHAPE)
    found, expected = (regular_patterns(plane[:-3, :-5], Device(1, name)) for name in (isa, "portable"))
    assert (expected.certainty > 0.01).sum() > 20
    np.testing.assert_allclose(found.certainty, expected.certainty, atol=1e-4)
    sure = expected.certainty > 0.01
    np.testing.assert_allclose(found.deviation[sure], expected.deviation[sure], rtol=1e-4)
    np.testing.assert_array_equal(found.frequency[sure], expected.frequency[sure])
