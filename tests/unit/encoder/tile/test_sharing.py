"""Seeds count less where detail has no direction, and in full on edges and smooth ground."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.ndimage

from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.sharing import MIN_WEIGHT, coherence, smoothed
from sgicodec.encoder.tile.stages import encode, prepare, share
from sgicodec.encoder.tile.state import Prepared, tile_of
from sgicodec.encoder.tile.writing import write
from sgicodec.picture import Picture

LMBDA = 0.002


def half_texture() -> np.ndarray:
    """Noise as in cloth on the left, soft lines on a smooth ground on the right, 256×128."""
    height, width = 128, 256
    rng = np.random.default_rng(1)
    y, x = np.mgrid[:height, :width]
    lines = np.full((height, width), 90.0)
    for _ in range(25):
        right, down = x - rng.uniform(0.55 * width, width), y - rng.uniform(0, height)
        length, angle = rng.uniform(6, 18), rng.uniform(0, np.pi)
        along, across = (right * np.cos(angle) + down * np.sin(angle), down * np.cos(angle) - right * np.sin(angle))
        lines += 100 * np.exp(-0.5 * (along / length) ** 2 - 0.25 * across**2)
    plane = np.where(x < width / 2, rng.normal(110, 40, (height, width)), lines)
    return np.repeat(np.clip(plane, 0, 255).astype(np.uint8)[..., None], 3, axis=2)


def shared(pixels: np.ndarray, channels: Any = "rgb", **settings: Any) -> Prepared:
    picture = Picture(pixels, channels, (0.0, 255.0))
    every: dict[str, Any] = {"lmbda": LMBDA, "effort": 2, "tune": "psnr"} | settings
    plan = stream_plan(Shape.of(picture), EncodeSettings(**every))
    return share(prepare(tile_of(picture, plan)))


def test_texture_counts_little_and_lines_count_much() -> None:
    weights = shared(half_texture()).weights
    assert weights.shape == (128, 256)
    assert weights[:, :96].max() < 0.15
    assert weights[:, 160:].mean() > max(0.35, 8 * weights[:, :96].mean())
    assert weights[:, 160:].max() > 0.8


def test_without_work_for_texture_seeds_count_in_full() -> None:
    ground = 120 + np.random.default_rng(2).integers(0, 3, (96, 160, 3))
    weights = shared(ground.astype(np.uint8)).weights
    assert weights.min() > 0.95


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 4, np.pi / 2, 2.5])
def test_stripes_of_any_direction_are_coherent_and_noise_is_not(angle: float) -> None:
    rows, columns = np.indices((96, 128))
    stripes = np.sin(0.5 * (np.cos(angle) * columns + np.sin(angle) * rows))[None].astype(np.float32)
    noise = np.random.default_rng(4).normal(size=(1, 96, 128)).astype(np.float32)
    assert coherence(stripes, 1e-6).min() > 0.97
    assert coherence(noise, 1e-6).max() < 0.6
    assert coherence(np.concatenate([stripes, stripes]), 1e-6) == pytest.approx(coherence(stripes, 1e-6), abs=1e-3)
    crossed = stripes + np.sin(0.5 * (np.sin(angle) * columns - np.cos(angle) * rows)).astype(np.float32)
    assert coherence(crossed, 1e-6).mean() < 0.75


def test_what_is_judged_stays_plain() -> None:
    part = shared(half_texture())
    assert part.weights is not None
    plain = shared(half_texture(), texture=False)
    assert plain.weights is None
    assert plain.fit.lmbda == LMBDA


def test_weights_of_masking_are_multiplied() -> None:
    part = shared(half_texture(), tune="visual")
    assert part.tile.weights is not None
    assert part.weights is not None
    ratio = part.weights / part.tile.weights
    assert np.all((ratio > 0.9 * MIN_WEIGHT) & (ratio <= 1 + 1e-6))
    assert ratio[:, :96].mean() < 0.3 * ratio[:, 160:].mean()


@pytest.mark.parametrize(
    ("shape", "channels"),
    [
        ((40, 50, 1), "gray"),
        ((40, 50, 2), "gray+alpha"),
        ((40, 50, 4), "rgba"),
        ((1, 1, 3), "rgb"),
        ((3, 70, 3), "rgb"),
    ],
)
def test_every_kind_of_picture(shape: tuple[int, ...], channels: str) -> None:
    pixels = np.random.default_rng(5).integers(0, 256, shape).astype(np.uint8)
    if channels in ("gray+alpha", "rgba"):
        pixels[: shape[0] // 2, ..., -1] = 0  # empty pixels
    part = shared(pixels, channels)
    weights = part.weights
    if weights is not None:
        assert weights.shape == shape[:2]
        assert weights.min() > 0
        assert weights.max() <= 1
    if not part.tile.holds_nothing:
        assert write(encode(part.tile)).payload


@pytest.mark.parametrize("shape", [(1, 1), (2, 7), (11, 5)])
def test_smoothing_is_a_mirrored_convolution(shape: tuple[int, int]) -> None:
    plane = np.random.default_rng(6).random(shape)
    expected = scipy.ndimage.gaussian_filter(plane, 0.7, mode="reflect")
    np.testing.assert_allclose(smoothed(plane, 0.7), expected, rtol=1e-12)


def test_a_stated_number_of_steps_stays() -> None:
    """Of noise, which seeds show next to nothing of."""
    noise = np.random.default_rng(3).integers(0, 256, (96, 128, 3)).astype(np.uint8)
    picture = Picture(noise, "rgb", (0.0, 255.0))
    usual, stated = (encode_picture(picture, EncodeSettings(**how)) for how in ({"effort": 1}, {"steps": 120}))
    assert usual.steps < 60
    assert stated.steps == 120
