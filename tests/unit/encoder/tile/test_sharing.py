"""Seeds count less where texture shows the picture for less bits, and in full on edges and smooth ground."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from half_texture import half_texture

from sgicodec.encoder.effort import UNSCOUTED_PRICE
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.sharing import (
    FULL,
    MIN_WEIGHT,
    TextureCosts,
    estimated_cost,
    smoothed,
    superblock_weights,
)
from sgicodec.encoder.tile.stages import encode, prepare, share
from sgicodec.encoder.tile.state import Prepared, tile_of
from sgicodec.encoder.tile.writing import write
from sgicodec.picture import Picture

LMBDA = 0.002


def shared(pixels: np.ndarray, channels: Any = "rgb", **settings: Any) -> Prepared:
    picture = Picture(pixels, channels, (0.0, 255.0))
    every: dict[str, Any] = {"lmbda": LMBDA, "effort": 2, "tune": "psnr"} | settings
    plan = stream_plan(Shape.of(picture), EncodeSettings(**every))
    return share(prepare(tile_of(picture, plan), plan.settings.fit_settings().lmbda))


@pytest.mark.parametrize(("effort", "most"), [(2, 0.15), (5, 0.25)])
def test_texture_counts_little_and_lines_count_much(effort: int, most: float) -> None:
    """At effort 5 seeds of texture count more at first, since they are handed over later."""
    weights = shared(half_texture(), effort=effort).weights
    assert weights is not None
    assert weights.shape == (128, 256)
    assert weights[:, :96].max() < most
    assert weights[:, 160:].mean() > max(0.35, 8 * weights[:, :96].mean())
    assert weights[:, 160:].max() > 0.8


def test_without_work_for_texture_seeds_keep_the_faster_code() -> None:
    ground = 120 + np.random.default_rng(2).integers(0, 3, (96, 160, 3))
    part = shared(ground.astype(np.uint8))
    assert part.weights is None


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_the_estimate_follows_the_search(channels: int) -> None:
    rng = np.random.default_rng(8)
    contrast = np.repeat(np.repeat(rng.uniform(0.005, 0.2, (3, 5)), 32, axis=0), 32, axis=1)
    residual = (contrast * rng.normal(size=(channels, 96, 160))).astype(np.float32)
    estimated, nothing = estimated_cost(residual, LMBDA)
    searched = TextureCosts(residual, LMBDA).over(residual)
    assert np.all(estimated <= nothing * (1 + 1e-6))
    assert np.corrcoef(np.log(estimated).ravel(), np.log(searched).ravel())[0, 1] > 0.95
    assert 0.5 < np.median(estimated / searched) < 1.2


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


def test_the_shortest_fits_have_no_shorter_one_before_them() -> None:
    part = shared(half_texture(), effort=1)
    assert part.weights is None
    assert part.fit.lmbda == UNSCOUTED_PRICE * LMBDA


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


def test_cells_count_as_their_seeds_save() -> None:
    price = np.full((9, 9), 1.0)
    for saved, expected in ((2.0, 1.0), (FULL * 1.001, 1.0), (0.0, MIN_WEIGHT)):
        np.testing.assert_allclose(superblock_weights(saved * price, price, 1e-9), expected, rtol=1e-6)
    rising = [superblock_weights(saved * price, price, 1e-9)[4, 4] for saved in (0.2, 0.3, 0.4, 0.5)]
    assert rising == sorted(set(rising))


def test_where_there_is_nothing_to_show_seeds_count_in_full() -> None:
    np.testing.assert_allclose(superblock_weights(np.zeros((4, 4)), np.zeros((4, 4)), LMBDA), 1.0)


@pytest.mark.parametrize("shape", [(1, 1), (2, 7), (11, 5)])
def test_smoothing_is_a_mirrored_convolution(shape: tuple[int, int]) -> None:
    sigma, plane = 0.7, np.random.default_rng(6).random(shape)
    offsets = range(-3, 4)

    def mirrored(index: int, size: int) -> int:
        index %= 2 * size
        return min(index, 2 * size - 1 - index)

    expected, total = np.zeros(shape), sum(np.exp(-0.5 * (i / sigma) ** 2) for i in offsets) ** 2
    for (y, x), (dy, dx) in ((a, b) for a in np.ndindex(shape) for b in ((i, j) for i in offsets for j in offsets)):
        weight = np.exp(-0.5 * (dy * dy + dx * dx) / sigma**2) / total
        expected[y, x] += weight * plane[mirrored(y + dy, shape[0]), mirrored(x + dx, shape[1])]
    np.testing.assert_allclose(smoothed(plane, sigma), expected, rtol=1e-12)
