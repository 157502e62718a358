"""SSIMULACRA 2 against the package of that name, and its gradient against torch and finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import ISAS
from seen_pictures import F32, Rgb8, by_jpeg, difference, photo, unit

from sgicodec.device import ONE_THREAD, Device
from sgicodec.errors import UsageError
from sgicodec.metrics.perceptual import ssimulacra2
from sgicodec.metrics.visual_score import VisualReference, visual_score


def noisy(pixels: Rgb8, deviation: float) -> Rgb8:
    noise = np.random.default_rng(3).normal(0, deviation, pixels.shape)
    return np.clip(np.rint(pixels + noise), 0, 255).astype(np.uint8)


def blurred(pixels: Rgb8) -> Rgb8:
    wide = np.pad(pixels.astype(np.float64), ((1, 1), (1, 1), (0, 0)), "edge")
    height, width, _ = pixels.shape
    shifted = [wide[y : y + height, x : x + width] for y in range(3) for x in range(3)]
    return np.rint(np.mean(shifted, 0)).astype(np.uint8)


DISTORTIONS = {
    "faint noise": lambda pixels: noisy(pixels, 1),
    "noise": lambda pixels: noisy(pixels, 12),
    "blur": blurred,
    "good JPEG": lambda pixels: by_jpeg(pixels, 95),
    "poor JPEG": lambda pixels: by_jpeg(pixels, 15),
}


def random_pair(height: int, width: int, channels: int = 3) -> tuple[F32, F32]:
    rng = np.random.default_rng(height + width)
    original = rng.uniform(0.1, 0.9, (channels, height, width)).astype(np.float32)
    return original, original + rng.uniform(-0.1, 0.1, original.shape).astype(np.float32)


@pytest.mark.parametrize("name", ["kodim13", "kodim23"])
@pytest.mark.parametrize("distort", DISTORTIONS.values(), ids=DISTORTIONS)
def test_scores_are_those_of_the_package(name: str, distort: object) -> None:
    pytest.importorskip("ssimulacra2")
    original = photo(name)
    decoded = distort(original)  # type: ignore[operator]
    expected = ssimulacra2(original, decoded)
    for isa in ISAS:
        assert visual_score(original, decoded, Device(1, isa)) == pytest.approx(expected, abs=0.005)


@pytest.mark.parametrize("shape", [(8, 8), (9, 23), (40, 16), (66, 131), (150, 257)])
def test_gradients_are_those_of_torch(shape: tuple[int, int]) -> None:
    pytest.importorskip("ssimulacra2")
    from torch_ssimulacra2 import gradient, score

    original, decoded = random_pair(*shape)
    pair = original.astype(np.float64), decoded.astype(np.float64)
    expected = gradient(*pair)
    for isa in ISAS:
        reference = VisualReference(original, Device(1, isa))
        value, found = reference.gradient(decoded)
        assert value == reference.score(decoded) == pytest.approx(score(*pair), abs=1e-3)
        assert difference(found, expected) < 1e-4


def test_gradients_are_those_of_torch_on_a_photograph() -> None:
    """Where most differences are small, and JPEG made flat blocks."""
    pytest.importorskip("ssimulacra2")
    from torch_ssimulacra2 import gradient

    original = photo("kodim13")
    decoded = by_jpeg(original, 80)
    _, found = VisualReference(unit(original)).gradient(unit(decoded))
    expected = gradient(*(pixels.transpose(2, 0, 1) / 255 for pixels in (original, decoded)))
    assert difference(found, expected) < 1e-3


@pytest.mark.parametrize("shape", [(11, 17), (49, 35)])
def test_gradients_are_finite_differences(shape: tuple[int, int]) -> None:
    pytest.importorskip("ssimulacra2")
    from torch_ssimulacra2 import score

    original, decoded = random_pair(*shape)
    _, found = VisualReference(original, ONE_THREAD).gradient(decoded)
    rng, step = np.random.default_rng(5), 1e-6
    for _ in range(5):
        direction = rng.normal(0, 1, decoded.shape)
        there, back = (score(original.astype(np.float64), decoded + sign * step * direction) for sign in (1, -1))
        assert (found * direction).sum() == pytest.approx((there - back) / (2 * step), rel=1e-3, abs=1e-2)


def test_a_step_along_the_gradient_raises_the_score() -> None:
    original = unit(photo("kodim13"))
    decoded = unit(by_jpeg(photo("kodim13"), 40))
    reference = VisualReference(original)
    before, gradient = reference.gradient(decoded)
    step = np.float32(0.5 / np.square(gradient).sum())  # half a point, were the score linear
    assert 0.25 < reference.score(decoded + step * gradient) - before < 0.75


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


@pytest.mark.parametrize("channels", [1, 2])
def test_one_channel_is_gray(channels: int) -> None:
    original, decoded = random_pair(37, 50, channels)
    score, gradient = VisualReference(original).gradient(decoded)
    three = VisualReference(original[:1].repeat(3, 0))
    expected, of_each = three.gradient(decoded[:1].repeat(3, 0))
    assert score == pytest.approx(expected, abs=1e-6)
    assert difference(gradient[0], of_each.sum(0)) < 1e-5
    assert not gradient[1:].any()


def test_channels_behind_the_third_count_nothing() -> None:
    original, decoded = random_pair(30, 21, 5)
    score, gradient = VisualReference(original).gradient(decoded)
    expected, of_three = VisualReference(original[:3]).gradient(decoded[:3])
    assert score == expected
    assert np.array_equal(gradient[:3], of_three)
    assert not gradient[3:].any()


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


def test_samples_are_clipped() -> None:
    original, decoded = random_pair(24, 33)
    decoded[:, :8], decoded[:, 8:16], decoded[1, 20, 5] = -0.25, 1.5, np.nan
    reference = VisualReference(original)
    score, gradient = reference.gradient(decoded)
    outside = ~((decoded >= 0) & (decoded <= 1))
    assert score == reference.score(np.nan_to_num(decoded).clip(0, 1))
    assert not gradient[outside].any()
    assert np.isfinite(gradient).all()
    assert gradient[~outside].all()


def test_wrong_shapes_are_refused() -> None:
    original, _ = random_pair(24, 33)
    with pytest.raises(UsageError, match=r"\(24, 33\)"):
        VisualReference(original[0])
    for call in (VisualReference(original).score, VisualReference(original).gradient):
        with pytest.raises(UsageError, match="does not fit"):
            call(original[:, 1:])
