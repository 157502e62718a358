"""Variance around pixels and the weights of squared error against windows one by one, and that tiles agree on them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec.metrics.local_variance import local_variance
from sgicodec.metrics.masking_weights import masking_weights
from sgicodec.metrics.psnr import luma

F32 = NDArray[np.float32]


def picture(channels: int, height: int = 40, width: int = 31) -> F32:
    """Noise [C, H, W] that grows to the right."""
    rng = np.random.default_rng(channels)
    return (0.5 + np.linspace(0, 0.4, width) * rng.uniform(-1, 1, (channels, height, width))).astype(np.float32)


def luma_of(samples: F32) -> np.ndarray:
    return luma(samples.transpose(1, 2, 0), peak=1.0)


@pytest.mark.parametrize("channels", [1, 2, 3, 4, 6])
def test_weights_are_those_of_the_windows(channels: int) -> None:
    samples = picture(channels)
    plane = samples[0].astype(np.float64) if channels < 3 else np.tensordot([0.299, 0.587, 0.114], samples[:3], axes=1)
    weights = masking_weights(luma_of(samples))
    assert weights.dtype == np.float32
    for y in range(40):
        for x in range(31):
            window = plane[max(0, y - 5) : y + 6, max(0, x - 5) : x + 6]
            assert weights[y, x] == pytest.approx(((np.var(window) + 1e-3) / 0.0025) ** -0.25, rel=1e-5)


def test_a_tile_that_overlaps_its_neighbours_has_the_weights_of_the_picture() -> None:
    samples = picture(3, 60, 70)
    whole = masking_weights(luma_of(samples))
    tile = masking_weights(luma_of(samples)[12:48, 20:64])
    np.testing.assert_allclose(tile[5:-5, 5:-5], whole[17:43, 25:59], rtol=1e-5)


@pytest.mark.parametrize("shape", [(1, 1), (3, 40), (70, 5), (150, 31)])
def test_it_is_the_variance_in_each_window(shape: tuple[int, int]) -> None:
    plane = np.random.default_rng(1).normal(3, 2, shape)
    found = local_variance(plane)
    for y, x in np.ndindex(shape):
        window = plane[max(y - 5, 0) : y + 6, max(x - 5, 0) : x + 6]
        assert found[y, x] == pytest.approx(window.var(), abs=1e-10)
