"""Native Butteraugli against `butteraugli_main` and a second implementation, its gradient against differences."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import ISAS
from seen_pictures import F32, assert_slope, by_jpeg, photo, unit

from sgicodec.device import ONE_THREAD, Device
from sgicodec.metrics.butteraugli import ButteraugliReference
from sgicodec.metrics.perceptual import Perceived, butteraugli

# Of sides under 15, where half the size is not looked at; odd ones; more rows than a thread takes at a time. The norm
# in float64 by a second implementation, in torch (commit 7b6ab0d), which agreed with `butteraugli_main` to 1e-4.
NORMS = {
    (8, 9): 0.9517792867756045,
    (14, 20): 1.2106607698514913,
    (17, 33): 1.3197593208540668,
    (64, 64): 1.5125683795841047,
    (150, 107): 1.5366028359107031,
}


def noisy_pair(height: int, width: int, channels: int = 3) -> tuple[F32, F32]:
    """Waves, and with a pattern that looks like noise; integers make it, so that every machine has the same."""
    c, y, x = np.mgrid[:channels, :height, :width]
    original = 0.5 + 0.3 * np.sin(x / 7 + c) * np.cos(y / (5 + c))
    noise = (7919 * x + 104729 * y + 1299709 * c + x * y) % 101 / 100 - 0.5
    return original.astype(np.float32), (original + 0.06 * noise).astype(np.float32)


@pytest.mark.skipif("butteraugli" not in Perceived.available(), reason="needs butteraugli_main of libjxl")
@pytest.mark.parametrize(("name", "quality"), [("kodim13", 20), ("kodim13", 90), ("kodim23", 50)])
def test_the_distance_is_what_libjxl_prints(name: str, quality: int) -> None:
    original = photo(name)
    decoded = by_jpeg(original, quality)
    distance, seen = ButteraugliReference(unit(original)).distance(unit(decoded))
    assert distance == pytest.approx(butteraugli(original, decoded), rel=2e-4)
    wide = seen.astype(np.float64)
    norms = [np.mean(wide**power) ** (1 / power) for power in (3, 6, 12)]
    assert distance == pytest.approx(np.mean(norms), rel=1e-6)


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize("shape", NORMS)
def test_the_norm_and_its_gradient(shape: tuple[int, int], isa: str) -> None:
    original, decoded = noisy_pair(*shape)
    native = ButteraugliReference(original, Device(1, isa))
    distance, seen, gradient = native.gradient(decoded)
    assert distance == pytest.approx(NORMS[shape], rel=1e-5)
    assert native.distance(decoded)[0] == distance
    assert np.array_equal(native.distance(decoded)[1], seen)
    assert_slope(lambda pixels: native.distance(pixels)[0], decoded, gradient, 1e-4, 0.01)


@pytest.mark.parametrize("channels", [1, 3])
def test_threads_change_no_bit(channels: int) -> None:
    original, decoded = noisy_pair(201, 77, channels)
    distance, seen, gradient = ButteraugliReference(original, ONE_THREAD).gradient(decoded)
    for threads in (2, 3, 8):
        again, map_again, same = ButteraugliReference(original, Device(threads)).gradient(decoded)
        assert distance == again
        assert np.array_equal(seen, map_again)
        assert np.array_equal(gradient, same)


@pytest.mark.parametrize("shape", [(1, 1), (7, 40), (300, 3)])
def test_nothing_differs_in_small_pictures(shape: tuple[int, int]) -> None:
    original = np.full((3, *shape), 0.2, np.float32)
    distance, seen, gradient = ButteraugliReference(original).gradient(2 * original)
    assert distance == 0
    assert seen.shape == shape
    assert not seen.any()
    assert not gradient.any()


@pytest.mark.parametrize("value", [None, 0.0, 1.0])
def test_gradients_of_equal_pictures_are_finite(value: float | None) -> None:
    original = noisy_pair(40, 33)[0] if value is None else np.full((3, 40, 33), value, np.float32)
    distance, _, gradient = ButteraugliReference(original).gradient(original)
    assert distance < 1e-5
    assert np.isfinite(gradient).all()
