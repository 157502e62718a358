"""Whether a picture was a JPEG file, on which grid, and what that saves."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import crop
from image_files import by_pillow

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.tile import state
from sgicodec.encoder.tile.jpeg_grid import jpeg_grid
from sgicodec.metrics.psnr import luma, psnr
from sgicodec.model.texture_symbols import LAPPED, TextureGrid

PHOTOS = {name: crop(name, np.s_[160:352, 80:336]).pixels for name in ("kodim13", "kodim23")}


def was_jpeg(pixels: np.ndarray, quality: int, subsampling: int = 0) -> np.ndarray:
    return read(by_pillow(pixels, "JPEG", quality=quality, subsampling=subsampling)).pixels


@pytest.mark.parametrize("name", PHOTOS)
@pytest.mark.parametrize("quality", [50, 75, 92])
@pytest.mark.parametrize(("left", "top"), [(0, 0), (3, 5), (7, 1)])
def test_the_grid_is_found_wherever_a_crop_begins(name: str, quality: int, left: int, top: int) -> None:
    pixels = was_jpeg(PHOTOS[name], quality, 2)[top:, left:]
    assert jpeg_grid(luma(pixels)) == TextureGrid(True, left, top)


@pytest.mark.parametrize("name", PHOTOS)
def test_a_photograph_has_none(name: str) -> None:
    assert jpeg_grid(luma(PHOTOS[name])) is None


@pytest.mark.parametrize("shape", [(1, 1), (14, 300), (300, 14), (15, 15)])
def test_small_tiles_are_looked_at_as_far_as_they_go(shape: tuple[int, int]) -> None:
    assert jpeg_grid(np.random.default_rng(0).uniform(0, 255, shape)) is None


def encoded(pixels: np.ndarray, quality: int) -> tuple[int, float, TextureGrid]:
    """Bytes of the stream, PSNR, and the grid of its texture."""
    settings = EncodeSettings(quality=quality, steps=60, texture=True)
    data = encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), settings).data
    with open_stream(data) as stream:
        texture = stream.model.texture
        assert texture is not None
        return len(data), psnr(stream.picture().pixels, pixels), texture.grid


def test_what_was_a_jpeg_takes_fewer_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    pixels = was_jpeg(PHOTOS["kodim13"], 85)[2:, 6:]
    size, quality, grid = encoded(pixels, 92)
    monkeypatch.setattr(state, "SEPARATE_COST", 0.0)
    lapped_size, lapped_quality, lapped_grid = encoded(pixels, 92)
    assert (grid, lapped_grid) == (TextureGrid(True, 6, 2), LAPPED)
    assert size < 0.9 * lapped_size
    assert quality > lapped_quality


def test_coarse_steps_do_not_follow_it() -> None:
    assert encoded(was_jpeg(PHOTOS["kodim13"], 92), 40)[2] == LAPPED
