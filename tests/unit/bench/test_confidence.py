"""Intervals of means: how often they hold the truth, and bytes at equal quality of curves whose relation is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgicodec.bench.bdrate import Curve
from sgicodec.bench.confidence import interval
from sgicodec.bench.savings import savings


def test_an_interval_holds_the_mean_of_the_population_about_as_often_as_it_says() -> None:
    """200 sets of 20 normal values, of mean 3."""
    sets = np.random.default_rng(1).normal(3, 2, (20, 200))
    low, high = interval(sets)
    assert low.shape == high.shape == (200,)
    held = np.mean((low <= 3) & (high >= 3))
    assert 0.88 <= held <= 0.98
    theirs = 2 * 2.093 * sets.std(axis=0, ddof=1) / math.sqrt(20)  # of Student's t
    assert np.mean((high - low) / theirs) == pytest.approx(1, abs=0.1)


def test_equal_values_and_too_few() -> None:
    low, high = interval(np.full(5, -7.0))
    assert (float(low), float(high)) == (-7, -7)
    assert all(math.isnan(float(end)) for end in interval(np.array([1.0, 2.0])))
    assert interval(np.array([1.0, 2.0, 4.0])) == interval(np.array([1.0, 2.0, 4.0]))


RATES = np.array([0.1, 0.2, 0.4, 0.8])


def test_savings_of_scaled_rates() -> None:
    anchors = {name: Curve(RATES, 30 + 5 * np.log2(RATES) + shift) for name, shift in (("a", 0), ("b", 2), ("c", 1))}
    factors = {"a": 0.5, "b": 0.8, "c": 0.7}
    tests = {name: Curve(RATES * factor, anchors[name].qualities) for name, factor in factors.items()}
    found = savings(anchors, tests, (-math.inf, 27.0))
    assert (found.qualities[0], found.qualities[-1]) == pytest.approx((32 + 5 * math.log2(0.1), 27))
    assert found.percent == pytest.approx(100 * ((0.5 * 0.8 * 0.7) ** (1 / 3) - 1))
    assert np.all((found.low < found.percent) & (found.percent < found.high))
    assert np.all((found.low >= -50.0001) & (found.high <= -19.9999))


def test_curves_that_share_no_quality_have_no_savings() -> None:
    anchors = {"a": Curve(RATES, [20, 21, 22, 23]), "b": Curve(RATES, [25, 26, 27, 28])}
    assert savings(anchors, anchors, (-math.inf, math.inf)) is None
    assert savings(anchors, {}, (-math.inf, math.inf)) is None
    assert savings({"a": Curve([1], [20])}, {"a": Curve([1], [20])}, (-math.inf, math.inf)) is None
