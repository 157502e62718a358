"""Calibration of a quality: gradients of a picture move λ, the same in windows and for all tiles."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest
from data_files import DATA
from numpy.typing import NDArray

from sgicodec import EncodeSettings, Picture, read
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.plan import Plan, stream_plan
from sgicodec.encoder.quality_calibration import (
    CalibratedSteps,
    log_gradients,
    quality_offset,
    with_quality_calibration,
)
from sgicodec.profiles.default import lmbda_of_quality


@pytest.fixture(scope="module")
def photo() -> Picture:
    return read(DATA / "kodim13.png")


def planned(picture: Picture, **settings: object) -> tuple[Plan, Plan]:
    windows = windows_of(picture)
    plan = stream_plan(windows.shape, EncodeSettings(**settings))  # type: ignore[arg-type]
    return plan, with_quality_calibration(windows, plan)


def picture_of(pixels: NDArray[np.float64]) -> Picture:
    return Picture(np.clip(np.rint(255 * pixels), 0, 255).astype(np.uint8), "rgb", (0.0, 255.0))


def noise(seed: int, shape: tuple[int, ...]) -> NDArray[np.float64]:
    return np.random.default_rng(seed).normal(0, 0.08, shape)


def test_the_figures_are_those_of_a_plain_reckoning(photo: Picture) -> None:
    luma = photo.pixels[:64, :64] / 255.0 @ [0.25, 0.625, 0.125]
    across, down = np.zeros((64, 64)), np.zeros((64, 64))
    for y in range(64):
        for x in range(64):
            across[y, x] = (luma[y, x + 1] - luma[y, x]) ** 2 if x < 63 else 0
            down[y, x] = (luma[y + 1, x] - luma[y, x]) ** 2 if y < 63 else 0
    corner = replace(photo, pixels=photo.pixels[:64, :64])
    assert log_gradients(corner, None)[0, 0] == pytest.approx(np.log((across + down).mean() + 1e-4))


def test_fine_grain_gets_more_bits_than_the_same_contrast_in_soft_clouds() -> None:
    fine = noise(1, (256, 256, 1))
    soft = 8 * noise(2, (32, 32, 1)).repeat(8, 0).repeat(8, 1) / 8
    means = [log_gradients(picture_of(0.5 + one.repeat(3, 2)), None).mean(axis=0) for one in (fine, soft)]
    grain, clouds = (quality_offset(mean, 50) for mean in means)
    assert grain > clouds + 3


def test_the_offset_is_bounded_and_fades_towards_the_highest_quality(photo: Picture) -> None:
    usual = log_gradients(photo, None).mean(axis=0)
    offsets = [quality_offset(usual, quality) for quality in (1, 30, 50, 70, 90, 100)]
    assert offsets[-1] == 0
    assert offsets == sorted(offsets, reverse=True)
    assert abs(quality_offset(np.array([9.0, -9.0, 0.0, 0.0]), 20)) == 10


def test_λ_moves_by_the_offset_and_for_all_tiles_alike(photo: Picture) -> None:
    before, after = planned(photo, quality=55.0)
    offset = quality_offset(log_gradients(photo, None).mean(axis=0), 55)
    assert offset > 1
    assert after.settings.lmbda == pytest.approx(lmbda_of_quality(55 + offset), rel=0.02)
    assert after.header.colour_step < before.header.colour_step
    tiled = planned(photo, quality=55.0, tile=256)[1]
    assert tiled.settings.lmbda == after.settings.lmbda
    assert tiled.software == before.software


@pytest.mark.parametrize(
    "settings",
    [{"tune": "psnr"}, {"lmbda": 0.01}, {"size": 9000}, {"bpp": 0.5}, {"psnr": 30.0}, {"ssimulacra2": 60.0}],
    ids=lambda settings: next(iter(settings)),
)
def test_what_was_asked_for_otherwise_stays(photo: Picture, settings: dict[str, object]) -> None:
    before, after = planned(photo, **settings)
    assert after is before
    assert after.calibrated_quality is None


def test_gray_pictures_are_told_by_luma_alone(photo: Picture) -> None:
    gray = Picture(photo.pixels[..., 1:2], "gray", (0.0, 255.0))
    found, of_photo = (log_gradients(picture, None).mean(axis=0) for picture in (gray, photo))
    np.testing.assert_allclose(found[:2], of_photo[:2], atol=0.5)
    grey_of_three = Picture(np.repeat(gray.pixels, 3, axis=2), "rgb", (0.0, 255.0))
    np.testing.assert_allclose(found[:2], log_gradients(grey_of_three, None).mean(axis=0)[:2], rtol=1e-5)
    assert planned(gray)[1].calibrated_quality == 50
    alone = quality_offset(np.array([*found[:2], -7.56, -7.37]), 50)
    assert quality_offset(found, 50) == pytest.approx(alone)


def test_bands_and_tiny_pictures_stay_where_they_are(photo: Picture) -> None:
    bands = Picture(photo.pixels, "multi", (0.0, 255.0))
    before, after = planned(bands)
    assert after is before
    tiny = replace(photo, pixels=photo.pixels[:40, :300])
    assert planned(tiny)[1].settings.lmbda == lmbda_of_quality(50)


def test_pixels_without_content_play_no_part(photo: Picture) -> None:
    colours = photo.pixels[:256, :256]
    alpha = np.full((256, 256, 1), 255, np.uint8)
    whole = Picture(np.concatenate([colours, alpha], axis=2), "rgba", (0.0, 255.0))
    alpha[:, 128:] = 0
    noisy = np.random.default_rng(3).integers(0, 256, colours.shape, dtype=np.uint8)
    half = Picture(np.concatenate([np.where(alpha > 0, colours, noisy), alpha], axis=2), "rgba", (0.0, 255.0))
    every = log_gradients(whole, "transparent").reshape(4, 4, 4)
    np.testing.assert_array_equal(log_gradients(half, "transparent"), every[:, :1].reshape(-1, 4))


def test_a_large_picture_is_looked_at_in_few_windows() -> None:
    windows = windows_of(Picture(np.zeros((1100, 6000, 3), np.uint8), "rgb", (0.0, 255.0)))
    watched = Mock(wraps=windows, shape=windows.shape)
    with_quality_calibration(watched, stream_plan(windows.shape, EncodeSettings()))
    reads = [call.args for call in watched.read.mock_calls]
    assert 1 < len(reads) <= 16
    assert reads == sorted(reads, key=lambda read: (read[1], read[0]))
    assert all(0 <= x <= 6000 - w and 0 <= y <= 1100 - h and max(w, h) <= 512 for x, y, w, h in reads)


def test_a_single_tile_is_brought_to_the_look_of_its_quality(photo: Picture) -> None:
    assert planned(photo, quality=55.0)[1].calibrated_quality == 55
    assert planned(photo, quality=55.0, tile=256)[1].calibrated_quality is None


def test_steps_of_texture_become_finer_where_the_score_is_too_low() -> None:
    steps = CalibratedSteps(57.0, 400, passes=5)
    assert steps.after(None) == 400
    low = steps.after(60.0)
    assert 390 < low < 400
    assert steps.after(66.0) == low  # near enough, with what is still to come
    assert steps.after(80.0) > low + 9
    assert steps.after(66.0) == steps.step
    assert steps.after(20.0) == steps.step  # the last pass keeps its steps
