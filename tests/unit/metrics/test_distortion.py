"""Squared error against that of whole pictures in float64."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgicodec.metrics.distortion import decibels, squared_error
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Picture


def test_it_is_that_of_psnr() -> None:
    random = np.random.default_rng(0)
    a, b = (Picture(random.integers(0, 256, (150, 40, 3), np.uint8), "rgb", (0.0, 255.0)) for _ in range(2))
    error = squared_error(a, b)
    assert error == pytest.approx(np.sum((a.pixels / 255.0 - b.pixels / 255.0) ** 2), rel=1e-6)
    assert decibels(error, a.pixels.size) == pytest.approx(psnr(a.pixels, b.pixels), abs=1e-5)
    assert decibels(0.0, 10) == math.inf


def test_colours_that_nobody_sees_count_nothing() -> None:
    a, b = (np.full((2, 2, 4), value, np.uint8) for value in (0, 255))
    a[0, :, 3] = b[0, :, 3] = 0
    a[1, :, 3] = 255
    pictures = (Picture(pixels, "rgba", (0.0, 255.0)) for pixels in (a, b))
    assert squared_error(*pictures) == pytest.approx(2 * 3)
