"""Tables of how fits go: sound everywhere, and what is between two entries lies between them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.rate_control.convergence import DONE, LAMBDAS, STEPS, course, searched


@given(st.floats(0, 1), st.integers(1, 10**5), st.floats(1e-9, 10))
def test_sound_everywhere(done: float, steps: int, lmbda: float) -> None:
    ratio, lift = course(done, steps, lmbda)
    assert 0.8 < ratio < 4
    assert -6 < lift < 1


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("lmbda", LAMBDAS)
def test_forecasts_rise_and_shrink_towards_the_outcome(steps: int, lmbda: float) -> None:
    assert DONE[-1] == 1.0
    ratios, lifts = zip(*(course(done, steps, lmbda) for done in DONE), strict=True)
    assert ratios[-1] == pytest.approx(1.0, abs=0.1)
    assert -0.1 < lifts[-1] < 0.6
    assert ratios[0] > 1.4
    assert lifts[0] < -0.5
    assert max(ratios[1:]) < ratios[0]
    assert max(lifts[:4]) < lifts[-1] - 0.3
    grown = [course(done, steps, lmbda)[0] / course(1.0, steps, lmbda)[0] for done in (0.33, 0.49, 0.66, 0.83)]
    assert grown == sorted(grown, reverse=True)


@pytest.mark.parametrize("part", [0, 1])
def test_between_entries(part: int) -> None:
    steps, lmbda = round((STEPS[0] * STEPS[1]) ** 0.5), (LAMBDAS[0] * LAMBDAS[1]) ** 0.5
    corners = [course(0.33, s, at)[part] for s in STEPS[:2] for at in LAMBDAS[:2]]
    assert course(0.33, steps, lmbda)[part] == pytest.approx(sum(corners) / 4, abs=1e-3)
    halfway = [course(done, STEPS[0], LAMBDAS[0])[part] for done in (0.33, 0.345, 0.36)]
    assert halfway[1] == pytest.approx((halfway[0] + halfway[2]) / 2)
    assert course(0.3, 10, 9.0) == course(0.3, STEPS[0], LAMBDAS[-1])
    assert course(0.3, 9999, 1e-5) == course(0.3, STEPS[-1], LAMBDAS[0])


@pytest.mark.parametrize("steps", STEPS)
def test_a_search_gains_and_gains_most_where_bits_are_cheap(steps: int) -> None:
    shares, decibels = zip(*(searched(steps, lmbda) for lmbda in LAMBDAS), strict=True)
    assert all(0.9 < share < 1.0 for share in shares)
    assert 0.1 < decibels[2] < decibels[1] < decibels[0] < 1.0
