"""The metrics against closed forms and against direct sums over every window."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec.errors import UsageError
from sgicodec.metrics import scores as metrics

WEIGHTS = [0.0448, 0.2856, 0.3001, 0.2363, 0.1333]


def noisy_pair(height: int, width: int, channels: int = 3, seed: int = 0) -> tuple[npt.NDArray, npt.NDArray]:
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width]
    base = 128 + 70 * np.sin(x / 7)[..., None] * np.cos(y / 5)[..., None] * np.linspace(0.5, 1, channels)
    a = np.clip(base, 0, 255).astype(np.uint8)
    b = np.clip(base * 0.9 + rng.normal(0, 12, base.shape), 0, 255).astype(np.uint8)
    return a, b


def direct_luma(pixels: npt.NDArray) -> npt.NDArray:
    r, g, b = (pixels[..., i].astype(float) for i in range(3))
    return 0.299 * r + 0.587 * g + 0.114 * b


def direct_ssim(a: npt.NDArray, b: npt.NDArray) -> tuple[float, float]:
    """Weighted means, variances and covariance of every 11×11 window, one window at a time."""
    offsets = np.arange(-5, 6)
    window = np.exp(-(offsets[:, None] ** 2 + offsets[None, :] ** 2) / (2 * 1.5**2))
    window /= window.sum()
    c1, c2 = 6.5025, 58.5225
    whole, contrast = [], []
    for i in range(a.shape[0] - 10):
        for j in range(a.shape[1] - 10):
            x, y = a[i : i + 11, j : j + 11], b[i : i + 11, j : j + 11]
            mx, my = (window * x).sum(), (window * y).sum()
            vx, vy = (window * (x - mx) ** 2).sum(), (window * (y - my) ** 2).sum()
            cov = (window * (x - mx) * (y - my)).sum()
            contrast.append((2 * cov + c2) / (vx + vy + c2))
            whole.append(contrast[-1] * (2 * mx * my + c1) / (mx**2 + my**2 + c1))
    return float(np.mean(whole)), float(np.mean(contrast))


def direct_halve(plane: npt.NDArray) -> npt.NDArray:
    height, width = plane.shape
    out = np.empty(((height + 1) // 2, (width + 1) // 2))
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            rows, cols = (2 * i, min(2 * i + 1, height - 1)), (2 * j, min(2 * j + 1, width - 1))
            out[i, j] = np.mean([plane[r, c] for r in rows for c in cols])
    return out


@pytest.mark.parametrize(
    ("dtype", "offset", "peak"),
    [(np.uint8, 3, 255), (np.uint16, 3, 65535), (np.float32, 0.25, 1), (float, 0.25, 1)],
)
def test_psnr_of_a_constant_offset(dtype: type, offset: float, peak: float) -> None:
    a = np.full((300, 5, 4), 0.5 if peak == 1 else 7, dtype)
    b = (a + offset).astype(dtype)
    assert metrics.psnr(a, b) == pytest.approx(20 * math.log10(peak / offset), abs=1e-9)
    assert metrics.psnr(b, a) == metrics.psnr(a, b)


def test_psnr_counts_every_channel_and_row() -> None:
    a = np.zeros((257, 3, 4), np.uint8)
    b = a.copy()
    b[256, 2, 3] = 255
    assert metrics.psnr(a, b) == pytest.approx(10 * math.log10(a.size))


def test_equal_pictures_are_perfect() -> None:
    a, _ = noisy_pair(180, 181)
    assert metrics.scores(a, a) == metrics.Scores(math.inf, math.inf, pytest.approx(1.0), pytest.approx(1.0))
    assert metrics.largest_difference(a, a) == 0


def test_luma_weights_and_scale() -> None:
    colour = np.array([[[10, 200, 30]]], np.uint8)
    expected = 0.299 * 10 + 0.587 * 200 + 0.114 * 30
    assert metrics.luma(colour)[0, 0] == pytest.approx(expected)
    assert metrics.luma(colour.astype(np.uint16) * 257)[0, 0] == pytest.approx(expected)
    assert metrics.luma(colour / 255.0)[0, 0] == pytest.approx(expected)
    with_alpha = np.concatenate([colour, np.full((1, 1, 1), 255, np.uint8)], axis=2)
    assert metrics.luma(with_alpha)[0, 0] == pytest.approx(expected)
    assert metrics.luma(np.array([[[40, 255]]], np.uint8))[0, 0] == 40


def test_luma_psnr_sees_only_luma() -> None:
    a = np.zeros((4, 4, 3), np.uint8)
    b = a.copy()
    b[..., 2] = 100
    assert metrics.luma_psnr(a, b) == pytest.approx(20 * math.log10(255 / 11.4))


def test_ssim_of_flat_pictures_is_its_luminance_term() -> None:
    a, b = np.full((20, 30, 1), 100, np.uint8), np.full((20, 30, 1), 140, np.uint8)
    expected = (2 * 100 * 140 + 6.5025) / (100**2 + 140**2 + 6.5025)
    assert metrics.ssim(a, b) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("shape", [(11, 11), (23, 40), (151, 13)])
def test_ssim_equals_the_direct_sum(shape: tuple[int, int]) -> None:
    a, b = noisy_pair(*shape)
    assert metrics.ssim(a, b) == pytest.approx(direct_ssim(direct_luma(a), direct_luma(b))[0], abs=1e-10)


@pytest.mark.parametrize(
    ("shape", "scales"), [((21, 60), 1), ((22, 23), 2), ((45, 57), 3), ((87, 91), 3), ((88, 89), 4)]
)
def test_ms_ssim_equals_the_direct_sum(shape: tuple[int, int], scales: int) -> None:
    a, b = noisy_pair(*shape)
    x, y = direct_luma(a), direct_luma(b)
    weights = np.array(WEIGHTS[:scales]) / sum(WEIGHTS[:scales])
    expected = 1.0
    for scale, weight in enumerate(weights):
        whole, contrast = direct_ssim(x, y)
        expected *= (whole if scale == scales - 1 else contrast) ** weight
        x, y = direct_halve(x), direct_halve(y)
    assert metrics.ms_ssim(a, b) == pytest.approx(expected, abs=1e-10)


def test_ms_ssim_uses_five_scales_from_176_pixels_on() -> None:
    a, b = noisy_pair(176, 176)
    terms = []
    x, y = direct_luma(a), direct_luma(b)
    for _ in range(5):
        terms.append(direct_ssim(x, y))
        x, y = direct_halve(x), direct_halve(y)
    contrasts = [contrast for _, contrast in terms[:4]]
    expected = math.prod(map(pow, contrasts, WEIGHTS[:4])) * terms[4][0] ** WEIGHTS[4]
    assert metrics.ms_ssim(a, b) == pytest.approx(expected, abs=2e-4)  # the published weights sum to 1.0001
    assert sum(WEIGHTS) == pytest.approx(1.0001)


def test_inverted_contrast_counts_as_zero() -> None:
    a, _ = noisy_pair(64, 64, 1)
    assert metrics.ssim(a, 255 - a) < 0
    assert metrics.ms_ssim(a, 255 - a) == 0


@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (7, 12)])
def test_tiny_pictures_have_scores(shape: tuple[int, int]) -> None:
    a = np.full((*shape, 3), 10, np.uint8)
    b = np.full((*shape, 3), 20, np.uint8)
    expected = (2 * 10 * 20 + 6.5025) / (10**2 + 20**2 + 6.5025)
    assert metrics.ssim(a, b) == pytest.approx(expected)
    assert metrics.ms_ssim(a, b) == pytest.approx(expected)


def test_scores_are_the_single_figures() -> None:
    a, b = noisy_pair(60, 50)
    expected = metrics.Scores(metrics.psnr(a, b), metrics.luma_psnr(a, b), metrics.ssim(a, b), metrics.ms_ssim(a, b))
    assert metrics.scores(a, b) == expected


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 30), st.integers(1, 30), st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_scores_are_symmetric_and_bounded(height: int, width: int, channels: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.integers(0, 65536, (2, height, width, channels), np.uint16)
    there, back = metrics.scores(a, b), metrics.scores(b, a)
    assert there.psnr == back.psnr
    assert there.ssim == pytest.approx(back.ssim, abs=1e-12)
    assert -1 <= there.ssim <= 1
    assert 0 <= there.ms_ssim <= 1


def test_error_map_is_signed_and_amplified() -> None:
    a = np.array([[[100, 100, 100, 100]]], np.uint8)
    b = np.array([[[100, 103, 97, 255]]], np.uint8)
    assert metrics.error_map(a, b, gain=10).tolist() == [[[128, 158, 98, 255]]]
    wide_a, wide_b = a.astype(np.uint16) * 257, b.astype(np.uint16) * 257
    assert metrics.error_map(wide_a, wide_b, gain=10).tolist() == [[[128, 158, 98, 255]]]
    with pytest.raises(UsageError, match="gain"):
        metrics.error_map(a, b, gain=0)


def test_largest_difference_is_absolute() -> None:
    a = np.array([[[0, 200]]], np.uint8)
    b = np.array([[[150, 0]]], np.uint8)
    assert metrics.largest_difference(a, b) == metrics.largest_difference(b, a) == 200


@pytest.mark.parametrize("measure", [metrics.psnr, metrics.luma_psnr, metrics.ssim, metrics.ms_ssim, metrics.scores])
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
