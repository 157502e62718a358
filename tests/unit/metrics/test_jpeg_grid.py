"""Whether a picture was a JPEG file, on which grid, and what that saves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from data_files import crop
from image_files import by_pillow
from text_pages import text

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.tile import state
from sgicodec.metrics.jpeg_grid import jpeg_grid, jpeg_saving
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
    assert jpeg_grid(luma(pixels)) == (left, top)


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


@pytest.mark.parametrize("name", PHOTOS)
@pytest.mark.parametrize("quality", [60, 90])
def test_a_photograph_takes_fewer_bits_on_its_grid(name: str, quality: int) -> None:
    plane = luma(was_jpeg(PHOTOS[name], quality)[3:, 2:])
    saving = jpeg_saving(plane, (2, 3))
    assert saving > 0.5 * plane.size
    assert saving > jpeg_saving(plane, (6, 7)) + 0.5 * plane.size


@pytest.mark.parametrize("quality", [None, 95])
def test_text_does_not(quality: int | None) -> None:
    page = text(320, 256)
    assert jpeg_saving(luma(page if quality is None else was_jpeg(page, quality)), (0, 0)) < 0


@pytest.mark.parametrize("max_error", [0, 4])
def test_what_was_a_jpeg_takes_fewer_bytes_without_loss(max_error: int) -> None:
    pixels = was_jpeg(PHOTOS["kodim13"], 85)[2:, 6:]

    def size_of(**changes: Any) -> int:
        settings = EncodeSettings(max_error=max_error, steps=60, **changes)
        data = encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), settings).data
        with open_stream(data) as stream:
            off = np.abs(stream.picture().pixels.astype(int) - pixels)
        assert off.max() == max_error
        return len(data)

    assert size_of() < 0.9 * size_of(quality=50)
