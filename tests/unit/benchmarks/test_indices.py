"""Differences of NDVI, worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.indices import difference, main, ndvi


def test_ndvi() -> None:
    pixels = np.array([[[50, 9, 150], [100, 9, 100], [0, 9, 0], [200, 9, 0]]], np.uint8)
    np.testing.assert_allclose(ndvi(pixels, 0, 2), [[0.5, 0, 0, -1]])


def test_a_difference() -> None:
    true = np.full((16, 16), 0.39)
    found = true.copy()
    found[:8] += 0.02  # in the class above 0.4
    found[8:, ::2] += 0.04
    found[8:, 1::2] -= 0.04
    off = difference(found, true)
    assert off.bias == pytest.approx(0.01)
    assert off.rms == pytest.approx(np.sqrt((0.02**2 + 0.04**2) / 2))
    assert off.rms_of_squares == pytest.approx(np.sqrt(0.02**2 / 2))
    assert off.worst == pytest.approx(0.04)
    assert off.moved == 0.75


def test_bands_that_are_not_there() -> None:
    result = CliRunner().invoke(main, ["tests/data/naip.tif", "--infrared", "5"])
    assert "has 4, counted from 1" in str(result.exception)
