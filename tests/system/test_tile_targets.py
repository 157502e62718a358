"""Pictures of several tiles that end at a size or a PSNR, all tiles together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import Encoded, EncodeSettings, Picture, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import TargetMissedError
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Metadata

DATA = Path(__file__).parents[1] / "data"
SETTINGS = EncodeSettings(steps=40, tile=96, tune="psnr")
GEO_WITH_NODATA_0 = bytes.fromhex("49492a00 08000000 0100 81a40200 02000000 30000000 00000000")


def crop(name: str, x: int, y: int, width: int, height: int) -> Picture:
    picture = read(DATA / name)
    return replace(picture, pixels=np.ascontiguousarray(picture.pixels[y : y + height, x : x + width]))


@pytest.fixture(scope="module", params=["kodim23.png", "kodim13.png"])
def photo(request: pytest.FixtureRequest) -> Picture:
    """280×180 pixels in 3×2 tiles."""
    return crop(request.param, 96, 128, 280, 180)


def quality(picture: Picture, encoded: Encoded) -> float:
    return psnr(picture.pixels, open_stream(encoded.data).picture().pixels)


@pytest.mark.parametrize("bpp", [0.3, 1.0])
def test_bits_per_pixel(photo: Picture, bpp: float) -> None:
    encoded = encode_picture(photo, replace(SETTINGS, bpp=bpp))
    assert 0.97 * bpp <= 8 * len(encoded.data) / (photo.width * photo.height) <= bpp
    with open_stream(encoded.data) as stream:
        assert stream.grid.count == 6
        survey = stream.survey()
    assert survey.part_bytes == pytest.approx(encoded.part_bytes)
    assert survey.seeds == encoded.seeds
    plain = encode_picture(photo, replace(SETTINGS, lmbda=encoded.lmbda))
    worth = 1.5 * np.log2(len(plain.data) / len(encoded.data)) / 0.5  # dB, generously
    assert quality(photo, encoded) > quality(photo, plain) - max(0.0, worth) - 0.3


@pytest.mark.parametrize("decibels", [24.0, 29.0])
def test_decibels(photo: Picture, decibels: float) -> None:
    encoded = encode_picture(photo, replace(SETTINGS, psnr=decibels))
    assert quality(photo, encoded) == pytest.approx(decibels, abs=0.1)


def test_tiles_that_differ_and_metadata() -> None:
    """A flat half and a busy one: the size holds for both together, whatever else the stream keeps."""
    busy = crop("kodim13.png", 0, 300, 256, 128)
    pixels = busy.pixels.copy()
    pixels[:, :128] = pixels[:, :128].mean(axis=(0, 1)).astype(np.uint8)
    picture = Picture(pixels, "rgb", (0.0, 255.0), Metadata(xmp=b"<x/>" * 500))
    encoded = encode_picture(picture, replace(SETTINGS, tile=128, size=5000.0))
    assert 0.97 * 5000 <= len(encoded.data) <= 5000


def test_an_impossible_size_gives_the_smallest_stream(photo: Picture) -> None:
    with pytest.raises(TargetMissedError, match="at most 200 bytes") as caught:
        encode_picture(photo, replace(SETTINGS, size=200.0, steps=10))
    nearest = caught.value.nearest
    assert f"the smallest has {len(nearest.data)}" in str(caught.value)
    assert len(nearest.data) < 1500
    assert quality(photo, nearest) > 8


@pytest.mark.slow
def test_an_impossible_psnr_gives_the_best_stream(photo: Picture) -> None:
    with pytest.raises(TargetMissedError, match="99 dB") as caught:
        encode_picture(photo, replace(SETTINGS, psnr=99.0, steps=20))
    assert f"reaches {quality(photo, caught.value.nearest):.2f} dB" in str(caught.value)
    assert quality(photo, caught.value.nearest) > 27


@pytest.mark.slow
def test_a_size_beyond_all_need_is_met(photo: Picture) -> None:
    assert len(encode_picture(photo, replace(SETTINGS, size=1e13, steps=4)).data) < 1e6


@pytest.mark.parametrize("target", [{"bpp": 0.5}, {"psnr": 26.0}])
@pytest.mark.parametrize("whole_tiles", [False, True])
def test_pixels_that_hold_nothing(target: dict[str, float], whole_tiles: bool) -> None:
    pixels = np.maximum(crop("kodim23.png", 96, 128, 200, 192).pixels, 1)
    pixels[:, : 100 if whole_tiles else 30] = 0
    picture = Picture(pixels, "rgb", (0.0, 255.0), Metadata(geo=GEO_WITH_NODATA_0))
    assert picture.nodata == 0
    encoded = encode_picture(picture, replace(SETTINGS, **target))  # type: ignore[arg-type]
    decoded = open_stream(encoded.data).picture().pixels
    np.testing.assert_array_equal((decoded == 0).all(axis=2), (pixels == 0).all(axis=2))
    if "bpp" in target:
        assert 0.97 * 0.5 <= 8 * len(encoded.data) / (200 * 192) <= 0.5
    else:
        assert psnr(pixels, decoded) == pytest.approx(26.0, abs=0.1)


@pytest.mark.parametrize("target", [{"bpp": 0.5}, {"psnr": 26.0}])
def test_a_picture_that_holds_nothing(target: dict[str, float]) -> None:
    picture = Picture(np.zeros((100, 200, 3), np.uint8), "rgb", (0.0, 255.0), Metadata(geo=GEO_WITH_NODATA_0))
    encoded = encode_picture(picture, replace(SETTINGS, **target))  # type: ignore[arg-type]
    assert not open_stream(encoded.data).picture().pixels.any()
    assert len(encoded.data) < 400


@pytest.mark.parametrize("choices", [{"prior": 0}, {"rdoq": False}])
def test_models_that_are_searched_otherwise_or_not_at_all(choices: dict[str, int]) -> None:
    """Networks of their own take 8 KB in each tile."""
    picture, size = crop("kodim23.png", 96, 128, 280, 180), 60_000.0 if "prior" in choices else 9000.0
    encoded = encode_picture(picture, replace(SETTINGS, size=size, **choices))  # type: ignore[arg-type]
    assert 0.97 * size <= len(encoded.data) <= size
    assert quality(picture, encoded) > 20


def test_the_stream_names_its_target(photo: Picture) -> None:
    encoded = encode_picture(photo, replace(SETTINGS, steps=10, bpp=0.5))
    assert open_stream(encoded.data).software.endswith("bpp0.5 psnr n10")
