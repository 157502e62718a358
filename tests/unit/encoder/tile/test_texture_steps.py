"""Steps of texture from λ, and offsets of superblocks by masking and by patterns."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest
from data_files import crop
from numpy.typing import NDArray

from sgicodec import EncodeSettings, Picture, decode, encode_picture
from sgicodec._native import CONTRAST_LIMIT
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.tile.texture_steps import TUNINGS, Masking, TextureTuning
from sgicodec.metrics.perceptual import ssimulacra2
from sgicodec.metrics.psnr import luma
from sgicodec.model.texture_symbols import TEXTURE_STEP_COUNT, TextureIndices
from sgicodec.picture import to_unit


@pytest.fixture(scope="module")
def rocks() -> Picture:
    """A sky over rocks, 192×160."""
    return crop("kodim13", np.s_[20:180, 100:292])


@pytest.mark.parametrize("tuning", TUNINGS.values(), ids=TUNINGS)
def test_what_rounding_takes_from_steps_the_price_gives_back(tuning: TextureTuning) -> None:
    lmbdas = np.geomspace(1e-4, 0.1, 97)
    prices = [
        tuning.price(lmbda) * (tuning.steps(tuning.step(lmbda), 3).of_channels[0] * 2 ** (tuning.finer / 32)) ** 2
        for lmbda in lmbdas
    ]
    np.testing.assert_allclose(prices / lmbdas, prices[0] / lmbdas[0], rtol=1e-5)
    indices = [tuning.step(lmbda) for lmbda in lmbdas]
    assert indices == sorted(indices)


@pytest.mark.parametrize("channels", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("step", [-5, 0, 300, TEXTURE_STEP_COUNT + 9])
def test_steps_fit_their_fields(channels: int, step: int) -> None:
    for tuning in TUNINGS.values():
        steps = tuning.steps(step, channels)
        assert len(steps.ratios) == channels - 1
        assert 0 <= steps.step < TEXTURE_STEP_COUNT
        assert all(0 <= slope < 32 for slope in steps.slopes)


def test_squared_error_has_equal_steps() -> None:
    """In all superblocks."""
    assert TUNINGS["psnr"].steps(300, 3).slopes == (0, 0)
    assert Masking(TUNINGS["psnr"], None).offsets(TextureIndices(300)) is None


def test_a_score_is_met(rocks: Picture, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "ssimulacra2", None)  # the package is the ruler, and not needed
        data = encode_picture(rocks, EncodeSettings(ssimulacra2=55, steps=60)).data
    assert ssimulacra2(rocks.pixels, decode(data)) == pytest.approx(55, abs=1)


def test_tuned_for_the_eye_the_score_is_better_at_equal_bytes() -> None:
    picture, scores = crop("kodim13", np.s_[20:276, 100:484]), {}
    for tune in ("psnr", "visual"):
        data = encode_picture(picture, EncodeSettings(bpp=0.8, steps=120, tune=tune)).data  # type: ignore[arg-type]
        scores[tune] = ssimulacra2(picture.pixels, decode(data))
    assert scores["visual"] > scores["psnr"] + 15


def test_a_tile_that_is_too_large_has_none() -> None:
    small = Picture(np.zeros((32, 32, 3), np.uint8), "rgb", (0.0, 255.0))
    shape = replace(Shape.of(small), width=8192, height=8192)
    settings = EncodeSettings(tile=0)
    assert stream_plan(Shape.of(small), settings).header.spec.texture
    assert not stream_plan(shape, settings).header.spec.texture
    assert stream_plan(shape, replace(settings, tile=1024)).header.spec.texture


TUNING = TUNINGS["visual"]
FINE, USUAL, COARSE = 300, 370, 460  # indices: 5, 23 and 164 levels


@pytest.fixture(scope="module")
def unit(rocks: Picture) -> NDArray[np.float32]:
    """The same as samples [C, H, W]."""
    return np.ascontiguousarray(to_unit(rocks).transpose(2, 0, 1))


def step_offsets(picture: NDArray[np.float32], step: int = USUAL) -> NDArray[np.int8]:
    found = Masking(TUNING, luma(picture.transpose(1, 2, 0), peak=1.0)).offsets(TUNING.steps(step, len(picture)))
    assert found is not None
    return found


def ribs(deviation: float) -> NDArray[np.float32]:
    """Noise that has ribs of this standard deviation, levels, and a period of 3 pixels in its middle."""
    plane = np.random.default_rng(1).normal(128, 8, (160, 160))
    plane[64:96, 64:96] = 128 + deviation * 2**0.5 * np.sin(2 * np.pi * np.arange(32) / 3)
    return np.broadcast_to(plane / 255, (3, 160, 160)).astype(np.float32)


def test_contrasts_are_those_of_the_place(unit: NDArray[np.float32]) -> None:
    whole = step_offsets(unit)
    assert whole.shape == step_offsets(unit[:1]).shape == (5, 6)  # gray ones, too
    assert np.abs(whole).max() <= CONTRAST_LIMIT
    assert step_offsets(unit[:, 32:128, 64:160])[1, 1] == whole[2, 3]


def test_noise_hides_more_than_flat_ground() -> None:
    unit = np.full((3, 96, 160), 0.5, np.float32)
    unit[:, :, 64:] += np.random.default_rng(1).normal(0, 0.2, (96, 96)).astype(np.float32)
    offsets = step_offsets(unit)
    assert len(np.unique(offsets[:, 0])) == 1
    assert offsets[:, 3:].min() > offsets[0, 0] + 4


def test_ribs_that_steps_would_swallow_get_finer_ones() -> None:
    finer = step_offsets(ribs(9), FINE) - step_offsets(ribs(9), USUAL)
    assert finer[2, 2] >= 2
    finer[2, 2] = 0
    assert not finer.any()  # its neighbours show a part of the ribs at most


@pytest.mark.parametrize(("deviation", "step"), [(60, USUAL), (9, FINE)], ids=["strong", "fine steps"])
def test_ribs_that_stay_anyway_change_nothing(deviation: float, step: int) -> None:
    picture = ribs(deviation)
    np.testing.assert_array_equal(step_offsets(picture, step), step_offsets(picture, 200))


def test_ribs_that_would_need_far_finer_steps_are_left_to_go() -> None:
    np.testing.assert_array_equal(step_offsets(ribs(9), COARSE), step_offsets(ribs(9), FINE))
