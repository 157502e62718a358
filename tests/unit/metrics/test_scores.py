"""The figures that are reported together, and the picture of the error."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec.errors import UsageError
from sgicodec.metrics.psnr import luma_psnr, psnr
from sgicodec.metrics.scores import error_map, scores
from sgicodec.metrics.similarity import ms_ssim, ssim


@settings(max_examples=examples(30))
@given(st.integers(1, 30), st.integers(1, 30), st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_scores_are_symmetric_and_bounded(height: int, width: int, channels: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.integers(0, 65536, (2, height, width, channels), np.uint16)
    there, back = scores(a, b), scores(b, a)
    assert there.psnr == back.psnr
    assert there.ssim == pytest.approx(back.ssim, abs=1e-12)
    assert -1 <= there.ssim <= 1
    assert 0 <= there.ms_ssim <= 1


def test_error_map_is_signed_and_amplified() -> None:
    a = np.array([[[100, 100, 100, 100]]], np.uint8)
    b = np.array([[[100, 103, 97, 255]]], np.uint8)
    assert error_map(a, b, gain=10).tolist() == [[[128, 158, 98, 255]]]
    wide_a, wide_b = a.astype(np.uint16) * 257, b.astype(np.uint16) * 257
    assert error_map(wide_a, wide_b, gain=10).tolist() == [[[128, 158, 98, 255]]]
    with pytest.raises(UsageError, match="gain"):
        error_map(a, b, gain=0)


@pytest.mark.parametrize("measure", [psnr, luma_psnr, ssim, ms_ssim, scores])
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
