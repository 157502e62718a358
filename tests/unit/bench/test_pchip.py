"""The interpolant against hand-worked slopes, exact cases and dense sums."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec.bench.pchip import Pchip
from sgicodec.errors import UsageError


def test_slopes_worked_by_hand() -> None:
    # Secants 1, 3, 5: inner slopes are the harmonic means 2/(1+1/3) and 2/(1/3+1/5); ends 0 (sign) and
    # (3·5−3)/2.
    assert Pchip([0, 1, 2, 3], [0, 1, 4, 9]).slopes == pytest.approx([0, 1.5, 3.75, 6])
    # Steps 1 and 3, secants 2 and 1: weights 7 and 5 of 12; the end slopes are (5·2−1)/4 and (7·1−3·2)/4.
    assert Pchip([0, 1, 4], [0, 2, 5]).slopes == pytest.approx([2.25, 12 / (7 / 2 + 5 / 1), 0.25])
    # An extremum is flat; the end slope, (3·1+9)/2 = 6, is limited to three secants.
    assert Pchip([0, 1, 2], [0, 1, -8]).slopes == pytest.approx([3, 0, -14])


@pytest.mark.filterwarnings("error")
def test_vanishing_secants_give_flat_slopes() -> None:
    assert Pchip([0, 1, 2, 3], [0, 5e-324, 1, 2]).slopes[1] == 0
    assert Pchip([0, 1, 2, 3], [0, 1e-309, 2e-309, 1]).slopes[1] == pytest.approx(0, abs=1e-300)


def test_a_line_is_reproduced() -> None:
    x = np.array([0.0, 0.1, 2.0, 5.0])
    curve = Pchip(x, 3 * x - 1)
    at = np.linspace(0, 5, 41)
    assert curve(at) == pytest.approx(3 * at - 1)
    assert curve.integral(0.05, 4.5) == pytest.approx(1.5 * (4.5**2 - 0.05**2) - 4.45)


def test_two_points_are_a_line_and_outside_is_unknown() -> None:
    curve = Pchip([1, 3], [10, 30])
    assert curve([1, 2, 3]).tolist() == [10, 20, 30]
    assert np.isnan(curve([0.999, 3.001])).all()


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(0.01, 5), st.floats(0, 5)), min_size=2, max_size=9))
def test_monotone_data_give_a_monotone_curve_with_its_integral(steps: list[tuple[float, float]]) -> None:
    x, y = np.cumsum(np.array(steps), axis=0).T
    curve = Pchip(x, y)
    at = np.linspace(x[0], x[-1], 20001)
    values = curve(at)
    assert np.diff(values).min() > -1e-9
    assert curve(x) == pytest.approx(y)
    trapezoids = np.sum((values[1:] + values[:-1]) / 2 * np.diff(at))
    assert curve.integral(x[0], x[-1]) == pytest.approx(trapezoids, rel=1e-4, abs=1e-6)
    middle = x[0] + 0.37 * (x[-1] - x[0])
    parts = curve.integral(x[0], middle) + curve.integral(middle, x[-1])
    assert parts == pytest.approx(curve.integral(x[0], x[-1]))


@pytest.mark.parametrize(("x", "y"), [([1], [1]), ([1, 2], [1, 2, 3]), ([1, 1], [1, 2]), ([2, 1], [1, 2])])
def test_unusable_points_are_refused(x: list[float], y: list[float]) -> None:
    with pytest.raises(UsageError, match="interpolation needs"):
        Pchip(x, y)


def test_integral_stays_inside_the_data() -> None:
    with pytest.raises(UsageError, match=r"0\.\.3"):
        Pchip([1, 3], [1, 3]).integral(0, 3)
