"""Whether a picture was a JPEG file, on which grid, and what that saves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from data_files import crop
from image_files import was_jpeg
from text_pages import text

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.tile import state
from sgicodec.metrics.jpeg_grid import jpeg_grid, jpeg_saving
from sgicodec.metrics.psnr import luma, psnr
from sgicodec.model.texture_symbols import LAPPED, TextureGrid

PHOTOS = {name: crop(name, np.s_[160:352, 80:336]).pixels for name in ("kodim13", "kodim23")}


@pytest.mark.parametrize("name", PHOTOS)
@pytest.mark.parametrize("quality", [50, 75, 92])
@pytest.mark.parametrize(("left", "top"), [(0, 0), (3, 5), (7, 1)])
def test_the_grid_is_found_wherever_a_crop_begins(name: str, quality: int, left: int, top: int) -> None:
    pixels = PHOTOS[name]
    assert jpeg_grid(luma(pixels[top:, left:])) is None
    assert jpeg_grid(luma(was_jpeg(pixels, quality, 2)[top:, left:])) == (left, top)


@pytest.mark.parametrize("shape", [(1, 1), (14, 300), (300, 14), (15, 15)])
def test_small_tiles_are_looked_at_as_far_as_they_go(shape: tuple[int, int]) -> None:
    assert jpeg_grid(np.random.default_rng(0).uniform(0, 255, shape)) is None


def encoded(pixels: np.ndarray, **settings: Any) -> tuple[int, np.ndarray, TextureGrid]:
    """Bytes of the stream, its pixels, and the grid of its texture."""
    data = encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), EncodeSettings(steps=60, **settings)).data
    with open_stream(data) as stream:
        return len(data), stream.picture().pixels, stream.model.texture.grid


def test_what_was_a_jpeg_takes_fewer_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    pixels = was_jpeg(PHOTOS["kodim13"], 85)[2:, 6:]
    size, found, grid = encoded(pixels, quality=92)
    monkeypatch.setattr(state, "SEPARATE_COST", 0.0)
    lapped_size, lapped, lapped_grid = encoded(pixels, quality=92)
    assert (grid, lapped_grid) == (TextureGrid(True, 6, 2), LAPPED)
    assert size < 0.9 * lapped_size
    assert psnr(found, pixels) > psnr(lapped, pixels)


def test_coarse_steps_do_not_follow_it() -> None:
    assert encoded(was_jpeg(PHOTOS["kodim13"], 92), quality=40)[2] == LAPPED


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
    size, found, _ = encoded(pixels, max_error=max_error)
    plain_size, plain, _ = encoded(pixels, max_error=max_error, quality=50)
    assert all(np.abs(decoded.astype(int) - pixels).max() == max_error for decoded in (found, plain))
    assert size < 0.9 * plain_size
