"""Tables of how fits go: sound everywhere, and what is between two entries lies between them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.rate_control.convergence import DONE, LMBDAS, STEPS, expected


@given(st.floats(0, 1), st.integers(1, 10**5), st.floats(1e-9, 10))
def test_sound_everywhere(done: float, steps: int, lmbda: float) -> None:
    ratio, offset = expected(done, steps, lmbda)
    assert 0.8 < ratio < 4
    assert -6 < offset < 1


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("lmbda", LMBDAS)
def test_ratios_rise_and_shrink_towards_the_outcome(steps: int, lmbda: float) -> None:
    assert DONE[-1] == 1.0
    ratios, offsets = zip(*(expected(done, steps, lmbda) for done in DONE), strict=True)
    assert ratios[-1] == pytest.approx(1.0, abs=0.1)
    assert -0.1 < offsets[-1] < 0.6
    assert ratios[0] > 1.4
    assert offsets[0] < -0.5
    assert max(ratios[1:]) < ratios[0]
    assert max(offsets[:4]) < offsets[-1] - 0.3
    grown = [expected(done, steps, lmbda)[0] / expected(1.0, steps, lmbda)[0] for done in (0.33, 0.49, 0.66, 0.83)]
    assert grown == sorted(grown, reverse=True)


@pytest.mark.parametrize("part", [0, 1])
def test_between_entries(part: int) -> None:
    steps, lmbda = round((STEPS[0] * STEPS[1]) ** 0.5), (LMBDAS[0] * LMBDAS[1]) ** 0.5
    corners = [expected(0.33, s, at)[part] for s in STEPS[:2] for at in LMBDAS[:2]]
    assert expected(0.33, steps, lmbda)[part] == pytest.approx(sum(corners) / 4, abs=1e-3)
    halfway = [expected(done, STEPS[0], LMBDAS[0])[part] for done in (0.33, 0.345, 0.36)]
    assert halfway[1] == pytest.approx((halfway[0] + halfway[2]) / 2)
    assert expected(0.3, 10, 9.0) == expected(0.3, STEPS[0], LMBDAS[-1])
    assert expected(0.3, 9999, 1e-5) == expected(0.3, STEPS[-1], LMBDAS[0])
