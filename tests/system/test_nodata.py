"""Pixels that hold nothing come back holding nothing, and cost little; places follow what is shown."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import crop
from surgery import flipped
from tags import TIED, geo_of, text

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError
from sgicodec.metadata.placement import view as geo_view
from sgicodec.picture import Metadata, nodata_mask

HEIGHT, WIDTH = 160, 200
TILES = [0, 128]


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    return crop("kodim23", np.s_[100 : 100 + HEIGHT, 150 : 150 + WIDTH]).pixels


@pytest.fixture(scope="module")
def hole() -> np.ndarray:
    """A corner, a disc and single pixels [H, W]."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    hole = (x + 0.4 * y < 60) | ((x - 140) ** 2 + (y - 70) ** 2 < 400)
    hole[100:150:10, 100:180:8] = True
    return hole


def settings(tile: int, **more: float) -> EncodeSettings:
    return EncodeSettings(steps=30, tile=tile, **more)


def holed(pixels: np.ndarray, hole: np.ndarray, value: float, nodata: bytes) -> Picture:
    """With a place."""
    pixels = pixels.copy()
    pixels[hole] = value
    sound = pixels[~hole]
    full = (0.0, float(np.iinfo(pixels.dtype).max)) if pixels.dtype.kind == "u" else None
    metadata = Metadata(geo=geo_of({**TIED, 42113: text(nodata)}))
    return Picture(pixels, "rgb", full or (float(sound.min()), float(sound.max())), metadata)


@pytest.mark.parametrize("tile", TILES)
@pytest.mark.parametrize(
    ("dtype", "value", "text"),
    [
        ("uint8", 0, b"0"),
        ("uint8", 255, b"255"),
        ("uint16", 7, b"7"),
        ("float32", -9999, b"-9999"),
        ("float32", np.nan, b"nan"),
    ],
)
def test_nodata_is_exact(
    pixels: np.ndarray, hole: np.ndarray, tile: int, dtype: str, value: float, text: bytes
) -> None:
    picture = holed(pixels.astype(dtype), hole, value, text)
    with open_stream(encode_picture(picture, settings(tile)).data) as stream:
        decoded = stream.picture()
        assert stream.metadata == picture.metadata
    np.testing.assert_array_equal(nodata_mask(decoded), nodata_mask(picture))
    assert np.isfinite(decoded.pixels[~hole]).all()


@pytest.mark.parametrize("tile", TILES)
@pytest.mark.parametrize(("value", "text"), [(0, b"0"), (255, b"255")])
def test_nodata_that_no_sample_has_stays_away(pixels: np.ndarray, tile: int, value: int, text: bytes) -> None:
    """A picture that is valid everywhere stays so, at any scale, however near to nodata it comes."""
    noise = np.random.default_rng(2).integers(1, 9, pixels.shape).astype(np.uint8)
    near = noise if value == 0 else 255 - noise
    stream = open_stream(
        encode_picture(holed(near, np.zeros(pixels.shape[:2], bool), value, text), settings(tile)).data
    )
    assert stream.header.masked == "nodata"
    for scale in (None, 0.3, 2.0):
        assert (stream.read(scale=scale) != value).all()


@pytest.mark.parametrize("tile", TILES)
def test_transparent_pixels_stay_transparent(pixels: np.ndarray, hole: np.ndarray, tile: int) -> None:
    hidden = np.random.default_rng(3).integers(0, 256, pixels.shape, np.uint8)
    colours = np.where(hole[..., None], hidden, pixels)
    alpha = np.where(hole, 0, 200).astype(np.uint8)
    picture = Picture(np.dstack([colours, alpha]), "rgba", (0.0, 255.0))
    data = encode_picture(picture, settings(tile)).data
    opaque = Picture(np.dstack([pixels, np.full_like(alpha, 200)]), "rgba", (0.0, 255.0))
    assert len(data) < 1.5 * len(encode_picture(opaque, settings(tile)).data)
    decoded = open_stream(data).picture().pixels
    assert not decoded[hole, 3].any()
    assert decoded[~hole, 3].min() > 150


@pytest.mark.parametrize("tile", TILES)
@pytest.mark.parametrize(("sx", "sy"), [(1, 1), (0.25, 0.25), (3, 2)])
def test_places_and_holes_follow_the_view(
    pixels: np.ndarray, hole: np.ndarray, tile: int, sx: float, sy: float
) -> None:
    picture = holed(pixels, hole, 0, b"0")
    stream = open_stream(encode_picture(picture, settings(tile)).data)
    shown = stream.picture((40, 20, 120, 100), size=(round(120 * sx), round(100 * sy)))
    assert shown.metadata.geo == geo_view(picture.metadata.geo, 40, 20, sx, sy)
    rows = np.floor(20 + (np.arange(shown.height) + 0.5) / sy).astype(int)
    columns = np.floor(40 + (np.arange(shown.width) + 0.5) / sx).astype(int)
    np.testing.assert_array_equal(nodata_mask(shown), hole[rows[:, None], columns])


def test_a_mask_that_lies_is_refused(pixels: np.ndarray, hole: np.ndarray) -> None:
    data = encode_picture(holed(pixels, hole, 0, b"0"), settings(128)).data
    for at in range(len(data) - 200, 60, -97):
        with pytest.raises(CorruptStreamError):
            open_stream(flipped(data, 8 * at + 2)).picture()
