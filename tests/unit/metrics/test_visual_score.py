"""SSIMULACRA 2 against the package of that name, and its gradient against finite differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import scipy.ndimage
from data_files import crop
from image_files import was_jpeg
from numpy.typing import NDArray
from scenes import ISAS

from sgicodec.device import ONE_THREAD, Device
from sgicodec.metrics.perceptual import ssimulacra2
from sgicodec.metrics.visual_score import VisualReference, visual_score

Rgb8 = NDArray[np.uint8]
F32 = NDArray[np.float32]


def noisy(pixels: Rgb8, deviation: float) -> Rgb8:
    noise = np.random.default_rng(3).normal(0, deviation, pixels.shape)
    return np.clip(np.rint(pixels + noise), 0, 255).astype(np.uint8)


def blurred(pixels: Rgb8) -> Rgb8:
    return np.rint(scipy.ndimage.uniform_filter(pixels.astype(np.float64), (3, 3, 1), mode="nearest")).astype(np.uint8)


DISTORTIONS = {
    "faint noise": lambda pixels: noisy(pixels, 1),
    "noise": lambda pixels: noisy(pixels, 12),
    "blur": blurred,
    "good JPEG": lambda pixels: was_jpeg(pixels, 95, 2),
    "poor JPEG": lambda pixels: was_jpeg(pixels, 15, 2),
}


def random_pair(height: int, width: int, channels: int = 3) -> tuple[F32, F32]:
    rng = np.random.default_rng(height + width)
    original = rng.uniform(0.1, 0.9, (channels, height, width)).astype(np.float32)
    return original, original + rng.uniform(-0.1, 0.1, original.shape).astype(np.float32)


@pytest.mark.parametrize("name", ["kodim13", "kodim23"])
@pytest.mark.parametrize("distort", DISTORTIONS.values(), ids=DISTORTIONS)
def test_scores_are_those_of_the_package(name: str, distort: object) -> None:
    pytest.importorskip("ssimulacra2")
    original = crop(name, np.s_[20:181, 60:275]).pixels
    decoded = distort(original)  # type: ignore[operator]
    expected = ssimulacra2(original, decoded)
    for isa in ISAS:
        assert visual_score(original, decoded, Device(1, isa)) == pytest.approx(expected, abs=0.005)


def assert_slope(value: Callable[[F32], float], at: F32, gradient: F32, step: float, rel: float) -> None:
    """In each quarter of the pixels [C, H, W], along the gradient itself: a step that float32 can tell."""
    height, width = at.shape[1:]
    for top in (0, height // 2):
        for left in (0, width // 2):
            way = np.zeros_like(at)
            part = slice(None), slice(top, top + height // 2), slice(left, left + width // 2)
            way[part] = gradient[part] / np.abs(gradient[part]).max()
            there, back = (value((at + sign * step * way).astype(np.float32)) for sign in (1, -1))
            expected = (there - back) / (2 * step)
            assert float((gradient * way).sum()) == pytest.approx(expected, rel=rel)


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize("shape", [(11, 17), (49, 35), (64, 64), (90, 121)])
def test_gradients_are_finite_differences(shape: tuple[int, int], isa: str) -> None:
    original, decoded = random_pair(*shape)
    native = VisualReference(original, Device(1, isa))
    assert_slope(lambda pixels: native.gradient(pixels)[0], decoded, native.gradient(decoded)[1], 1e-3, 2e-3)


@pytest.mark.parametrize("channels", [1, 3])
def test_threads_change_no_bit(channels: int) -> None:
    original, decoded = random_pair(201, 77, channels)
    alone = VisualReference(original, ONE_THREAD)
    score, gradient = alone.gradient(decoded)
    for threads in (2, 3, 8):
        several = VisualReference(original, Device(threads))
        again, same = several.gradient(decoded)
        assert (score, score) == (again, several.score(decoded))
        assert np.array_equal(gradient, same)


@pytest.mark.parametrize("shape", [(1, 1), (7, 40), (300, 3)])
def test_small_pictures_have_no_scale(shape: tuple[int, int]) -> None:
    original, decoded = random_pair(*shape)
    score, gradient = VisualReference(original).gradient(decoded)
    assert score == VisualReference(original).score(decoded) == 100
    assert not gradient.any()


def test_equal_pictures_have_the_best_score_and_no_gradient() -> None:
    original, _ = random_pair(64, 70)
    score, gradient = VisualReference(original).gradient(original.copy())
    assert score == 100
    assert not gradient.any()
