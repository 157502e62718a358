"""Intervals of means: how often they hold the truth."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgicodec.bench.confidence import interval


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
