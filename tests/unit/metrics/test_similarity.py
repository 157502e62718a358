"""Structural similarity against closed forms and direct sums over every window."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from sgicodec.metrics.scores import scores

WEIGHTS = [0.0448, 0.2856, 0.3001, 0.2363, 0.1333]


def noisy_pair(height: int, width: int, channels: int = 3, seed: int = 0) -> tuple[npt.NDArray, npt.NDArray]:
    """A picture of smooth waves [height, width, channels], and the same darker and with noise."""
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


@pytest.mark.parametrize("shape", [(11, 11), (23, 40), (151, 13)])
def test_ssim_equals_the_direct_sum(shape: tuple[int, int]) -> None:
    a, b = noisy_pair(*shape)
    assert scores(a, b).ssim == pytest.approx(direct_ssim(direct_luma(a), direct_luma(b))[0], abs=1e-10)


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
    assert scores(a, b).ms_ssim == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (7, 12)])
def test_tiny_pictures_have_scores(shape: tuple[int, int]) -> None:
    a = np.full((*shape, 3), 10, np.uint8)
    b = np.full((*shape, 3), 20, np.uint8)
    expected = (2 * 10 * 20 + 6.5025) / (10**2 + 20**2 + 6.5025)
    assert scores(a, b).ssim == pytest.approx(expected)
    assert scores(a, b).ms_ssim == pytest.approx(expected)
