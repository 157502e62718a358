"""PSNR and luma against closed forms; squared error of pictures against PSNR, and the picture of the error."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from sgicodec.errors import UsageError
from sgicodec.metrics.distortion import decibels, squared_error
from sgicodec.metrics.psnr import largest_difference, luma, psnr
from sgicodec.metrics.scores import error_map, scores
from sgicodec.picture import Picture


@pytest.mark.parametrize(
    ("dtype", "offset", "peak"),
    [(np.uint8, 3, 255), (np.uint16, 3, 65535), (np.float32, 0.25, 1), (float, 0.25, 1)],
)
def test_psnr_of_a_constant_offset(dtype: type, offset: float, peak: float) -> None:
    a = np.full((300, 5, 4), 0.5 if peak == 1 else 7, dtype)
    b = (a + offset).astype(dtype)
    assert psnr(a, b) == pytest.approx(20 * math.log10(peak / offset), abs=1e-9)
    assert psnr(b, a) == psnr(a, b)


def test_luma_weights_and_scale() -> None:
    colour = np.array([[[10, 200, 30]]], np.uint8)
    expected = 0.299 * 10 + 0.587 * 200 + 0.114 * 30
    assert luma(colour)[0, 0] == pytest.approx(expected)
    assert luma(colour.astype(np.uint16) * 257)[0, 0] == pytest.approx(expected)
    assert luma(colour / 255.0)[0, 0] == pytest.approx(expected)
    assert luma(np.concatenate([colour, np.full((1, 1, 1), 255, np.uint8)], axis=2))[0, 0] == pytest.approx(expected)
    assert luma(np.array([[[40, 255]]], np.uint8))[0, 0] == 40


def test_squared_error_is_that_of_psnr() -> None:
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
    assert squared_error(*(Picture(pixels, "rgba", (0.0, 255.0)) for pixels in (a, b))) == pytest.approx(2 * 3)


@pytest.mark.parametrize(
    ("a", "b", "largest"),
    [
        ([1, np.nan, np.inf], [3, np.nan, np.inf], 2),
        ([1, np.nan, 5], [3, 4, 5], math.inf),
        ([1, np.inf, 5], [3, -np.inf, 5], math.inf),
    ],
)
def test_what_is_not_a_number_in_both_differs_by_nothing(a: list[float], b: list[float], largest: float) -> None:
    first, second = (np.array(samples, np.float32).reshape(1, 3, 1) for samples in (a, b))
    assert largest_difference(first, second) == largest_difference(second, first) == largest


def test_integers_differ_either_way() -> None:
    assert largest_difference(np.array([[[0], [9]]], np.uint16), np.array([[[65535], [0]]], np.uint16)) == 65535


def test_error_map_is_signed_and_amplified() -> None:
    a = np.array([[[100, 100, 100, 100]]], np.uint8)
    b = np.array([[[100, 103, 97, 255]]], np.uint8)
    assert error_map(a, b, gain=10).tolist() == [[[128, 158, 98, 255]]]
    wide_a, wide_b = a.astype(np.uint16) * 257, b.astype(np.uint16) * 257
    assert error_map(wide_a, wide_b, gain=10).tolist() == [[[128, 158, 98, 255]]]
    for gain in (0, np.inf):
        with pytest.raises(UsageError, match="gain"):
            error_map(a, b, gain=gain)


@pytest.mark.parametrize("measure", [psnr, scores])
def test_unlike_pictures_are_refused(measure: Callable) -> None:
    a = np.zeros((12, 14, 3), np.uint8)
    with pytest.raises(UsageError, match="14x12 with 3 channels and 12x14 with 3 channels"):
        measure(a, np.zeros((14, 12, 3), np.uint8))
    with pytest.raises(UsageError, match="uint8 and uint16"):
        measure(a, a.astype(np.uint16))
    with pytest.raises(UsageError, match=r"\[H, W, C\]"):
        measure(a[..., 0], a[..., 0])
    with pytest.raises(UsageError, match="int32"):
        measure(a.astype(np.int32), a.astype(np.int32))
