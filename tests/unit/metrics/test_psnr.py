"""PSNR, luma and the largest difference against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgicodec.metrics.psnr import luma, psnr


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
    with_alpha = np.concatenate([colour, np.full((1, 1, 1), 255, np.uint8)], axis=2)
    assert luma(with_alpha)[0, 0] == pytest.approx(expected)
    assert luma(np.array([[[40, 255]]], np.uint8))[0, 0] == 40
