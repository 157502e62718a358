"""Bjøntegaard deltas on curves whose difference is known."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from sgicodec.bench.bdrate import Curve, bd_quality, bd_rate
from sgicodec.bench.rows import Results
from sgicodec.bench.summary import curves
from sgicodec.errors import UsageError

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


def test_a_range_of_qualities_leaves_out_the_rest() -> None:
    anchor = Curve([math.exp(q / 10) for q in (20, 25, 30)], [20, 25, 30])
    test = Curve([math.exp(q / 8 - 1) for q in (20, 25, 30)], [20, 25, 30])
    delta = bd_rate(anchor, test, within=(22, 24))
    assert (delta.low, delta.high) == (22, 24)
    assert delta.value == pytest.approx(100 * (math.exp(23 / 8 - 1 - 23 / 10) - 1))
    assert bd_rate(anchor, test, within=(31, 40)).reason == "the curves share no range of quality"


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


def test_lossless_points_are_dropped() -> None:
    curve = Curve([*RATES, 9.0], [*QUALITIES, math.inf])
    assert curve.qualities.tolist() == QUALITIES.tolist()


def test_no_common_quality_is_not_a_number_with_a_reason() -> None:
    delta = bd_rate(Curve([1, 2], [20, 25]), Curve([1, 2], [25, 30]))
    assert math.isnan(delta.value)
    assert delta.reason == "the curves share no range of quality"
    assert bd_quality(Curve([1, 2], [20, 25]), Curve([2, 3], [20, 25])).reason == "the curves share no range of rate"


def test_one_point_is_no_curve() -> None:
    delta = bd_rate(Curve(RATES, QUALITIES), Curve([1], [30]))
    assert math.isnan(delta.value)
    assert delta.reason == "a curve has fewer than two usable points"
    assert math.isnan(Curve([1], [30]).quality_at(1))


def test_quality_at_a_rate() -> None:
    curve = Curve(RATES, QUALITIES)
    assert curve.quality_at(0.5) == pytest.approx(34 - 6)
    assert math.isnan(curve.quality_at(0.05))


def test_impossible_points_are_refused() -> None:
    with pytest.raises(UsageError, match="positive"):
        Curve([0, 1], [20, 30])
    with pytest.raises(UsageError, match="1 for 2"):
        Curve([1, 2], [30])


def test_curves_are_monotone_cubics_between_the_points() -> None:
    # Qualities 0, 1, 4, 9 at log-rates 0..3: slopes 0, 3/2 and 15/4 (harmonic means of the secants 1, 3, 5) and 6.
    curve = Curve(np.exp([0, 1, 2, 3]), [0, 1, 4, 9])
    middles = [curve.quality_at(math.exp(x)) for x in (0.5, 1.5, 2.5)]
    assert middles == pytest.approx([1 / 2 - 1.5 / 8, 5 / 2 - 2.25 / 8, 13 / 2 - 2.25 / 8], abs=1e-9)
    # Over a unit interval the cubic's integral is the trapezoid's plus a twelfth of the fall of the slope.
    area = (1 / 2 - 1.5 / 12) + (5 / 2 - 2.25 / 12) + (13 / 2 - 2.25 / 12)
    assert bd_quality(Curve(np.exp([0, 3]), [0, 9]), curve).value == pytest.approx((area - 27 / 2) / 3, abs=1e-9)


def test_published_rows_give_the_published_figure() -> None:
    """−50.4 % of README for kodim05 against JPEG; all digits as the former interpolant of this package gave them."""
    table = Path(__file__).parents[3] / "docs" / "results" / "kodak8.tsv"
    rows = [row for row in Results(table).rows.values() if row.picture == "kodim05.png"]
    jpeg, ours = (curves(rows, codec)["kodim05.png 8154535e"] for codec in ("jpeg", "sgi"))
    assert bd_rate(jpeg, ours).value == pytest.approx(-50.3737859594657, abs=1e-9)
