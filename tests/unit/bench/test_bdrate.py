"""Bjøntegaard deltas on curves whose difference is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgicodec.bench.bdrate import Curve, bd_quality, bd_rate

RATES = np.array([0.1, 0.17, 0.3, 0.55, 0.8, 1.2])
QUALITIES = 34 + 6 * np.log2(RATES)


@pytest.mark.parametrize("factor", [0.9, 1.0, 1.25])
def test_a_scaled_rate_gives_that_percentage(factor: float) -> None:
    delta = bd_rate(Curve(RATES, QUALITIES), Curve(RATES * factor, QUALITIES))
    assert delta.value == pytest.approx(100 * (factor - 1), abs=1e-9)
    assert (delta.low, delta.high, delta.reason) == (QUALITIES[0], QUALITIES[-1], None)


def test_a_raised_quality_gives_that_many_decibels() -> None:
    delta = bd_quality(Curve(RATES, QUALITIES), Curve(RATES, QUALITIES + 0.7))
    assert delta.value == pytest.approx(0.7)
    assert (delta.low, delta.high) == pytest.approx((0.1, 1.2))


def test_partial_overlap_counts_only_the_common_range() -> None:
    # log-linear curves of different slope: the log-ratio at quality q is linear in q, so its mean is in the
    # middle.
    anchor = Curve([math.exp(q / 10) for q in (20, 25, 30)], [20, 25, 30])
    test = Curve([math.exp(q / 8 - 1) for q in (26, 31, 36)], [26, 31, 36])
    delta = bd_rate(anchor, test)
    assert (delta.low, delta.high) == (26, 30)
    assert delta.value == pytest.approx(100 * (math.exp(28 / 8 - 1 - 28 / 10) - 1))


def test_cubic_curves_against_a_dense_mean() -> None:
    def log_rate(q: np.ndarray, shift: float) -> np.ndarray:
        return -6 + 0.12 * q + 0.00002 * (q - 20) ** 3 + shift * np.sin(q / 6)

    q0, q1 = np.linspace(24, 40, 60), np.linspace(26, 44, 60)
    delta = bd_rate(Curve(np.exp(log_rate(q0, 0)), q0), Curve(np.exp(log_rate(q1, 0.05)), q1))
    dense = np.linspace(26, 40, 100001)
    assert delta.value == pytest.approx(100 * np.expm1(np.mean(0.05 * np.sin(dense / 6))), abs=5e-3)


def test_order_and_dominated_points_do_not_matter() -> None:
    shuffled = [3, 0, 5, 1, 4, 2]
    rates = [*RATES[shuffled], 0.9, 0.3]
    qualities = [*QUALITIES[shuffled], 20.0, 20.0]
    assert bd_rate(Curve(RATES, QUALITIES), Curve(rates, qualities)).value == pytest.approx(0, abs=1e-9)


def test_no_common_quality_is_not_a_number_with_a_reason() -> None:
    delta = bd_rate(Curve([1, 2], [20, 25]), Curve([1, 2], [25, 30]))
    assert math.isnan(delta.value)
    assert delta.reason == "the curves share no range of quality"
    assert bd_quality(Curve([1, 2], [20, 25]), Curve([2, 3], [20, 25])).reason == "the curves share no range of rate"
