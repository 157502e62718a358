"""Decisions between passes over tiles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.rate_control.tile_passes import is_far, kept_near, next_correction, spread_over, tiles_of_pass


def test_samples_are_spread_over_the_weights() -> None:
    assert spread_over(np.ones(9), 3) == [1, 4, 7]
    assert spread_over(np.array([0, 0, 9.0, 0, 0, 1.0]), 2) == [2]
    assert len(spread_over(np.zeros(40), 2)) == 2
    assert spread_over(np.ones(3), 9) == [0, 1, 2]


@given(st.integers(1, 100))
def test_passes_come_to_every_tile_once(count: int) -> None:
    done: list[int] = []
    passes = 0
    while len(done) < count:
        numbers = tiles_of_pass(np.ones(count), done)
        assert numbers
        assert not set(numbers) & set(done)
        done += numbers
        passes += 1
    assert sorted(done) == list(range(count))
    assert passes <= 3
    assert len(tiles_of_pass(np.ones(count), [])) <= max(2, min(8, count // 4))


def test_half_of_the_others_come_first_from_twelve_tiles_on() -> None:
    assert tiles_of_pass(np.ones(12), [0, 1, 2]) == [3, 5, 7, 9, 11]
    assert tiles_of_pass(np.ones(12), [0, 1, 2, 3, 5, 7, 9, 11]) == [4, 6, 8, 10]
    assert tiles_of_pass(np.ones(11), [0, 1]) == [2, 3, 4, 5, 6, 7, 8, 9, 10]


def test_lmbda_stay_within_half_an_octave() -> None:
    assert [is_far(0.01, at) for at in (0.0071, 0.0070, 0.0141, 0.0142)] == [False, True, False, True]
    assert kept_near(1.0, 0.01) == pytest.approx(0.01 * 2**0.5)
    assert kept_near(1e-5, 0.01) == pytest.approx(0.01 * 2**-0.5)
    assert kept_near(0.012, 0.01) == 0.012


EVEN = dict.fromkeys(range(40), 10.0)


@pytest.mark.parametrize(("coarser", "sign"), [(True, 1), (False, -1)])
def test_little_is_asked_of_few_tiles(coarser: bool, sign: int) -> None:
    octaves, numbers = next_correction(coarser, sign * 0.005, EVEN, list(EVEN), [])
    assert octaves == sign * 0.1
    assert len(numbers) == math.ceil(40 * 1.3 * 0.005 / 0.35 / 0.1)
    assert len(set(numbers)) == len(numbers)


def test_much_is_asked_of_all() -> None:
    assert next_correction(True, 0.1, EVEN, list(EVEN), []) == (pytest.approx(1.3 * 0.1 / 0.35), list(EVEN))
    assert next_correction(True, 9.0, EVEN, list(EVEN), []) == (4.0, list(EVEN))
    assert next_correction(False, -9.0, EVEN, list(EVEN), [])[0] == -4.0


def test_tiles_that_were_not_corrected_come_first() -> None:
    octaves, numbers = next_correction(True, 0.005, EVEN, range(20, 40), [(0.1, 0.02)])
    assert octaves == 0.1
    assert set(numbers) <= set(range(20, 40))
    assert len(numbers) == math.ceil(20 * 1.3 * 0.005 / 0.35 / 0.1 * 2)


@pytest.mark.parametrize("slope", [0.2, 0.5])
def test_a_straight_response_is_found(slope: float) -> None:
    """Two tries tell it; the third goes as far beyond as corrections do, a hundredth of an octave."""
    need, tried = 0.2, list[tuple[float, float]]()
    for _ in range(3):
        octaves, _ = next_correction(True, need, EVEN, list(EVEN) if not tried else [], tried)
        tried.append((octaves, need - slope * octaves))
    assert abs(tried[-1][1]) == pytest.approx(0.01, abs=1e-9)


def test_a_correction_that_gains_too_much_goes_back_past_the_fits() -> None:
    """A new search of every tile alone saves more than is needed: λ must fall below that of the fits."""
    saved, need = 0.12, 0.01
    octaves, numbers = next_correction(True, need, EVEN, [], [(0.1, need - saved - 0.35 * 0.1)])
    assert -0.1 <= octaves < 0
    assert numbers == list(EVEN)
