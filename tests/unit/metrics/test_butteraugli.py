"""Native Butteraugli against `butteraugli_main`, and its map and gradient against torch."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import ISAS
from seen_pictures import F32, by_jpeg, difference, photo, unit

from sgicodec.device import ONE_THREAD, Device
from sgicodec.errors import UsageError
from sgicodec.metrics.butteraugli import ButteraugliReference
from sgicodec.metrics.perceptual import Perceived, butteraugli

# Sides under 15, where half the size is not looked at; odd ones; more rows than a thread takes at a time.
SHAPES = [(8, 9), (14, 20), (17, 33), (64, 64), (150, 107)]


def noisy_pair(height: int, width: int, channels: int = 3) -> tuple[F32, F32]:
    """A part of a photograph, and with noise."""
    rng = np.random.default_rng(height + width)
    original = np.resize(unit(photo("kodim13"))[:, :height, :width], (channels, height, width))
    decoded = (original + rng.normal(0, 0.03, original.shape)).clip(0.001, 0.999)
    return np.ascontiguousarray(original), decoded.astype(np.float32)


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
@pytest.mark.parametrize("shape", SHAPES)
def test_maps_and_gradients_are_those_of_torch(shape: tuple[int, int], isa: str) -> None:
    torch = pytest.importorskip("torch")
    from torch_butteraugli import Reference

    original, decoded = noisy_pair(*shape)
    pixels = torch.from_numpy(decoded).double().requires_grad_()
    reference = Reference(torch.from_numpy(original).double())
    norm = reference.norm(pixels)
    norm.backward()
    native = ButteraugliReference(original, Device(1, isa))
    distance, seen, gradient = native.gradient(decoded)
    assert distance == pytest.approx(norm.item(), rel=1e-5)
    assert difference(seen, reference.differences(pixels).detach().numpy()) < 1e-5
    assert difference(gradient, pixels.grad.numpy()) < 2e-3
    assert native.distance(decoded)[0] == distance
    assert np.array_equal(native.distance(decoded)[1], seen)


def test_a_step_against_the_gradient_lowers_the_distance() -> None:
    original, decoded = unit(photo("kodim23")), unit(by_jpeg(photo("kodim23"), 40))
    reference = ButteraugliReference(original)
    before, _, gradient = reference.gradient(decoded)
    step = np.float32(0.02 * before / np.square(gradient).sum())  # 2 %, were the distance linear
    assert 0.96 < reference.distance(decoded - step * gradient)[0] / before < 0.99


@pytest.mark.parametrize("channels", [1, 3])
def test_threads_change_no_bit(channels: int) -> None:
    original, decoded = noisy_pair(201, 77, channels)
    distance, seen, gradient = ButteraugliReference(original, ONE_THREAD).gradient(decoded)
    for threads in (2, 3, 8):
        again, map_again, same = ButteraugliReference(original, Device(threads)).gradient(decoded)
        assert distance == again
        assert np.array_equal(seen, map_again)
        assert np.array_equal(gradient, same)


@pytest.mark.parametrize("channels", [1, 2])
def test_one_channel_is_gray(channels: int) -> None:
    original, decoded = noisy_pair(37, 50, channels)
    distance, _, gradient = ButteraugliReference(original).gradient(decoded)
    three = ButteraugliReference(original[:1].repeat(3, 0))
    expected, _, of_each = three.gradient(decoded[:1].repeat(3, 0))
    assert distance == pytest.approx(expected, rel=1e-6)
    assert difference(gradient[0], of_each.sum(0)) < 1e-5
    assert not gradient[1:].any()


def test_channels_behind_the_third_count_nothing() -> None:
    original, decoded = noisy_pair(30, 21, 5)
    distance, _, gradient = ButteraugliReference(original).gradient(decoded)
    expected, _, of_three = ButteraugliReference(original[:3]).gradient(decoded[:3])
    assert distance == expected
    assert np.array_equal(gradient[:3], of_three)
    assert not gradient[3:].any()


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


def test_samples_are_clipped() -> None:
    original, decoded = noisy_pair(24, 33)
    decoded[:, :8], decoded[:, 8:16], decoded[1, 20, 5] = -0.25, 1.5, np.nan
    reference = ButteraugliReference(original)
    distance, _, gradient = reference.gradient(decoded)
    outside = ~((decoded >= 0) & (decoded <= 1))
    assert distance == reference.distance(np.nan_to_num(decoded).clip(0, 1))[0]
    assert not gradient[outside].any()
    assert np.isfinite(gradient).all()
    assert gradient[~outside].all()


def test_wrong_shapes_are_refused() -> None:
    original, _ = noisy_pair(24, 33)
    with pytest.raises(UsageError, match=r"\(24, 33\)"):
        ButteraugliReference(original[0])
    for call in (ButteraugliReference(original).distance, ButteraugliReference(original).gradient):
        with pytest.raises(UsageError, match="does not fit"):
            call(original[:, 1:])
