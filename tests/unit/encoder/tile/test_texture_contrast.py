"""Contrasts of roots: busy places hide errors, regular patterns do not hide among them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec import read
from sgicodec.encoder.tile.texture_contrast import TextureContrasts
from sgicodec.encoder.tile.texture_tuning import TUNINGS
from sgicodec.model.texture_symbols import CONTRAST_LIMIT, TextureSteps
from sgicodec.picture import to_unit

PHOTO = Path(__file__).parents[3] / "data" / "kodim13.png"
TUNING = TUNINGS["visual"]
FINE, USUAL, COARSE = 300, 370, 460  # indices: 5, 23 and 164 levels


@pytest.fixture(scope="module")
def unit() -> NDArray[np.float32]:
    """A sky over rocks, 192×160."""
    return np.ascontiguousarray(to_unit(read(PHOTO))[20:180, 100:292].transpose(2, 0, 1))


def contrasts(picture: NDArray[np.float32], step: int = USUAL) -> NDArray[np.int8]:
    found = TextureContrasts(TUNING, picture).at(TUNING.steps(step, len(picture)))
    assert found is not None
    return found


def ribs(deviation: float) -> NDArray[np.float32]:
    """Noise that has ribs of this standard deviation, levels, and a period of 3 pixels in its middle."""
    plane = np.random.default_rng(1).normal(128, 8, (160, 160))
    plane[64:96, 64:96] = 128 + deviation * 2**0.5 * np.sin(2 * np.pi * np.arange(32) / 3)
    return np.broadcast_to(plane / 255, (3, 160, 160)).astype(np.float32)


def test_squared_error_has_none(unit: NDArray[np.float32]) -> None:
    assert TextureContrasts(TUNINGS["psnr"], unit).at(TextureSteps(USUAL)) is None


def test_contrasts_are_those_of_the_place(unit: NDArray[np.float32]) -> None:
    whole = contrasts(unit)
    assert whole.shape == (5, 6)
    assert np.abs(whole).max() <= CONTRAST_LIMIT
    assert contrasts(unit[:, 32:128, 64:160])[1, 1] == whole[2, 3]


def test_noise_hides_more_than_flat_ground() -> None:
    unit = np.full((3, 96, 160), 0.5, np.float32)
    unit[:, :, 64:] += np.random.default_rng(1).normal(0, 0.2, (96, 96)).astype(np.float32)
    contrast = contrasts(unit)
    assert len(np.unique(contrast[:, 0])) == 1
    assert contrast[:, 3:].min() > contrast[0, 0] + 4


def test_ribs_that_steps_would_swallow_get_finer_ones() -> None:
    finer = contrasts(ribs(9), FINE) - contrasts(ribs(9), USUAL)
    assert finer[2, 2] >= 2
    finer[2, 2] = 0
    assert not finer.any()  # its neighbours show a part of the ribs at most


@pytest.mark.parametrize(("deviation", "step"), [(40, USUAL), (9, FINE)], ids=["strong", "fine steps"])
def test_ribs_that_stay_anyway_change_nothing(deviation: float, step: int) -> None:
    picture = ribs(deviation)
    np.testing.assert_array_equal(contrasts(picture, step), contrasts(picture, 200))


def test_ribs_that_would_need_far_finer_steps_are_left_to_go() -> None:
    np.testing.assert_array_equal(contrasts(ribs(9), COARSE), contrasts(ribs(9), FINE))


def test_gray_pictures_have_contrasts(unit: NDArray[np.float32]) -> None:
    assert contrasts(unit[:1]).shape == (5, 6)
