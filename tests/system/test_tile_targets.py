"""Pictures of several tiles that end at a size or a PSNR, all tiles together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Metadata

DATA = Path(__file__).parents[1] / "data"
SETTINGS = EncodeSettings(steps=40, tile=96, tune="psnr")
GEO_WITH_NODATA_0 = bytes.fromhex("49492a00 08000000 0100 81a40200 02000000 30000000 00000000")


def crop(name: str, x: int, y: int, width: int, height: int) -> Picture:
    picture = read(DATA / name)
    return replace(picture, pixels=np.ascontiguousarray(picture.pixels[y : y + height, x : x + width]))


def test_tiles_that_differ_and_metadata() -> None:
    """A flat half and a busy one: the size holds for both together, whatever else the stream keeps."""
    busy = crop("kodim13.png", 0, 300, 256, 128)
    pixels = busy.pixels.copy()
    pixels[:, :128] = pixels[:, :128].mean(axis=(0, 1)).astype(np.uint8)
    picture = Picture(pixels, "rgb", (0.0, 255.0), Metadata(xmp=b"<x/>" * 500))
    encoded = encode_picture(picture, replace(SETTINGS, tile=128, size=5000.0))
    assert 0.97 * 5000 <= len(encoded.data) <= 5000


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
