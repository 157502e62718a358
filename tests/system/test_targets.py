"""Encodes that end at a size or a PSNR: a crop in few steps, pictures at the edge, all tiles together."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from data_files import crop

from sgicodec import Encoded, EncodeSettings, Picture, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import TargetMissedError
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Metadata, comparable


@pytest.fixture(scope="module", params=["kodim23", "kodim13"])
def photo(request: pytest.FixtureRequest) -> Picture:
    return crop(request.param, np.s_[128:320, 96:352])


def quality(picture: Picture, encoded: Encoded) -> float:
    decoded = open_stream(encoded.data).picture()
    assert decoded.pixels.shape == picture.pixels.shape
    return psnr(comparable(picture), comparable(decoded))


def test_size_and_metadata(photo: Picture) -> None:
    """Metadata counts."""
    with_blob = replace(photo, metadata=Metadata(xmp=b"<x/>" * 1000))
    encoded = encode_picture(with_blob, EncodeSettings(size=7000, steps=150))
    assert 0.97 * 7000 <= len(encoded.data) <= 7000
    lean = encode_picture(with_blob, EncodeSettings(size=3000, metadata=False, steps=150))
    assert 0.97 * 3000 <= len(lean.data) <= 3000
    assert abs(math.log2(encoded.lmbda / lean.lmbda)) < 1.3


@pytest.mark.parametrize(
    ("corner", "asked"), [((0, 400), 30.0), ((0, 400), 34.0), ((400, 600), 28.0), ((400, 600), 33.0)]
)
def test_decibels_of_a_stream_of_hundred_bytes(corner: tuple[int, int], asked: float) -> None:
    """Where a single symbol of texture moves the PSNR up or down by more than the tolerance. The first crop cannot have
    less than 29.7 dB, nor between 32.5 and 33.3: one of 104 bytes has 33.4.
    """
    top, left = corner
    small = crop("kodim23", np.s_[top : top + 96, left : left + 128])
    assert quality(small, encode_picture(small, EncodeSettings(psnr=asked, effort=1))) == pytest.approx(asked, abs=0.1)


@pytest.mark.parametrize("target", [{"size": 3000}, {"psnr": 34.0}])
def test_targets_without_texture(photo: Picture, target: dict[str, float]) -> None:
    """Seeds alone come as near."""
    encoded = encode_picture(photo, EncodeSettings(**target, texture=False, effort=1))
    if "size" in target:
        assert 0.97 * 3000 <= len(encoded.data) <= 3000
    else:
        assert quality(photo, encoded) == pytest.approx(34.0, abs=0.1)


def test_an_impossible_size_gives_the_nearest_stream(photo: Picture) -> None:
    with pytest.raises(TargetMissedError, match="at most 90 bytes") as caught:
        encode_picture(photo, EncodeSettings(size=90, steps=60))
    nearest = caught.value.nearest
    assert f"the smallest has {len(nearest.data)}" in str(caught.value)
    assert len(nearest.data) < 700
    assert quality(photo, nearest) > 8


def test_an_impossible_psnr_gives_the_nearest_stream() -> None:
    deep = drawn(48, 40, "gray", "uint16", False)
    with pytest.raises(TargetMissedError, match="99 dB") as caught:
        encode_picture(deep, EncodeSettings(psnr=99, steps=40))
    reached = quality(deep, caught.value.nearest)
    assert reached > 40
    assert f"{reached:.2f} dB" in str(caught.value)


def drawn(height: int, width: int, channels: str, dtype: str, flat: bool) -> Picture:
    """A ramp with noise, or one colour."""
    count = {"gray": 1, "gray+alpha": 2, "rgb": 3, "rgba": 4}[channels]
    y, x = np.mgrid[:height, :width]
    unit = np.stack([(x + (band + 1) * y) / (width + (band + 1) * height) for band in range(count)], axis=2)
    unit = 0.3 + 0 * unit if flat else 0.8 * unit + 0.2 * np.random.default_rng(1).random(unit.shape)
    if dtype == "float32":
        colours = count - (count in (2, 4))
        unit[..., :colours] = unit[..., :colours] * 900 - 100
        return Picture(unit.astype(np.float32), channels, (-100.0, 800.0))
    top = float(np.iinfo(dtype).max)
    return Picture(np.rint(unit * top).astype(dtype), channels, (0.0, top))


PICTURES = {
    "1×1": drawn(1, 1, "rgb", "uint8", True),
    "16×16": drawn(16, 16, "rgb", "uint8", False),
    "flat": drawn(40, 70, "rgb", "uint8", True),
    "gray": drawn(48, 40, "gray", "uint8", False),
    "alpha": drawn(40, 48, "rgba", "uint8", False),
    "gray and alpha of 16 bits": drawn(40, 48, "gray+alpha", "uint16", False),
    "floats": drawn(40, 48, "rgb", "float32", False),
}


@pytest.mark.parametrize("target", [{"psnr": 45.0}, {"size": 500.0}, {"bpp": 0.01}])
@pytest.mark.parametrize("picture", PICTURES.values(), ids=PICTURES)
def test_pictures_at_the_edge(picture: Picture, target: dict[str, float]) -> None:
    """Whatever can be told of them, a stream comes out, and what was not reached is said."""
    settings = replace(EncodeSettings(steps=12), **target)  # type: ignore[arg-type]
    missed = False
    try:
        encoded = encode_picture(picture, settings)
    except TargetMissedError as error:
        missed, encoded = True, error.nearest
    reached = quality(picture, encoded)
    limit = target.get("size", target.get("bpp", math.inf) * picture.width * picture.height / 8)
    assert missed == (len(encoded.data) > limit or reached < target.get("psnr", 0.0) - 0.1)


TILED = EncodeSettings(steps=40, tile=96, tune="psnr")
GEO_WITH_NODATA_0 = bytes.fromhex("49492a00 08000000 0100 81a40200 02000000 30000000 00000000")


def test_tiles_that_differ_and_metadata() -> None:
    """A flat half and a busy one: the size holds for both together, whatever else the stream keeps."""
    busy = crop("kodim13", np.s_[300:428, :256])
    pixels = busy.pixels.copy()
    pixels[:, :128] = pixels[:, :128].mean(axis=(0, 1)).astype(np.uint8)
    picture = Picture(pixels, "rgb", (0.0, 255.0), Metadata(xmp=b"<x/>" * 500))
    assert 0.97 * 5000 <= len(encode_picture(picture, replace(TILED, tile=128, size=5000.0)).data) <= 5000


@pytest.mark.parametrize("target", [{"bpp": 0.5}, {"psnr": 26.0}])
@pytest.mark.parametrize("whole_tiles", [False, True])
def test_pixels_that_hold_nothing(target: dict[str, float], whole_tiles: bool) -> None:
    pixels = np.maximum(crop("kodim23", np.s_[128:320, 96:296]).pixels, 1)
    pixels[:, : 100 if whole_tiles else 30] = 0
    picture = Picture(pixels, "rgb", (0.0, 255.0), Metadata(geo=GEO_WITH_NODATA_0))
    assert picture.nodata == 0
    encoded = encode_picture(picture, replace(TILED, **target))  # type: ignore[arg-type]
    decoded = open_stream(encoded.data).picture().pixels
    np.testing.assert_array_equal((decoded == 0).all(axis=2), (pixels == 0).all(axis=2))
    if "bpp" in target:
        assert 0.97 * 0.5 <= 8 * len(encoded.data) / (200 * 192) <= 0.5
    else:
        assert psnr(pixels, decoded) == pytest.approx(26.0, abs=0.1)
