"""Decisions between passes over tiles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.rate_control.tile_passes import is_far, kept_near, spread_over, tiles_of_pass


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
