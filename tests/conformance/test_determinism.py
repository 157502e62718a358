"""Equal input gives equal bytes, equal bytes give equal symbols, and every part of a picture is the same part."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import crop

from sgicodec import EncodeSettings, Picture, Stream, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ONE_THREAD, Device

SETTINGS = {
    "default": EncodeSettings(steps=60),
    "texture": EncodeSettings(steps=25, quality=85),
    "paper": EncodeSettings(profile="paper", steps=20, seeds=3000, per_seed=2, features=8),
}
"""The last has enough seeds for several threads to share them."""


@pytest.fixture(scope="module")
def picture() -> Picture:
    """192×128 pixels of a photograph."""
    return crop("kodim23", np.s_[128:256, 100:292])


@pytest.fixture(scope="module", params=list(SETTINGS))
def settings(request: pytest.FixtureRequest) -> EncodeSettings:
    """One of SETTINGS."""
    return SETTINGS[request.param]


@pytest.fixture(scope="module")
def data(picture: Picture, settings: EncodeSettings) -> bytes:
    """The stream, made by one thread."""
    return encode_picture(picture, settings, device=ONE_THREAD).data


@pytest.fixture
def stream(data: bytes) -> Stream:
    """The stream, opened."""
    return open_stream(data)


def test_the_settings_of_texture_give_some(picture: Picture) -> None:
    texture = open_stream(encode_picture(picture, SETTINGS["texture"]).data).model.texture
    assert {3, 4, 5} <= set(texture.log_size.flat)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_same_bytes_for_any_number_of_threads(
    picture: Picture, settings: EncodeSettings, data: bytes, threads: int
) -> None:
    assert encode_picture(picture, settings, device=Device(threads)).data == data


def test_same_pixels_for_any_number_of_threads(data: bytes) -> None:
    for scale in (None, 0.5, 1.7):
        one = open_stream(data, ONE_THREAD).render(scale=scale)
        for threads in (2, 3, 0):
            np.testing.assert_array_equal(open_stream(data, Device(threads)).render(scale=scale), one)


REGIONS = [(0, 0, 192, 128), (0, 0, 1, 1), (191, 127, 1, 1), (5, 3, 16, 16), (16, 32, 64, 48), (77, 0, 33, 128)]


@pytest.mark.parametrize("region", REGIONS)
def test_a_region_is_the_crop_of_the_picture(stream: Stream, region: tuple[int, int, int, int]) -> None:
    x, y, width, height = region
    np.testing.assert_array_equal(stream.render(region), stream.render()[y : y + height, x : x + width])
    np.testing.assert_array_equal(stream.picture(region).pixels, stream.picture().pixels[y : y + height, x : x + width])


@pytest.mark.parametrize("scale", [None, 0.37, 2.0])
def test_blocks_do_not_show(data: bytes, stream: Stream, scale: float | None, monkeypatch: pytest.MonkeyPatch) -> None:
    whole, pixels = stream.render(scale=scale), stream.picture(scale=scale).pixels
    monkeypatch.setattr("sgicodec.decoder.stream.BLOCK_SAMPLES", 2000)
    blocks = open_stream(data)
    np.testing.assert_array_equal(blocks.render(scale=scale), whole)
    np.testing.assert_array_equal(blocks.picture(scale=scale).pixels, pixels)


def test_scaled_regions_agree_with_scaled_pictures(stream: Stream) -> None:
    """Where the region starts on a whole output pixel, up to the rounding of its coordinates, which also decides
    whether a Gaussian reaches a pixel at its very end, 3.5 deviations out: 0.0022 of its amplitude, at most a half.
    """
    for scale, step in ((2.0, 1), (0.5, 2), (0.25, 4)):
        x, y, width, height = 8 * step, 4 * step, 10 * step, 7 * step
        part = stream.render((x, y, width, height), scale=scale)
        left, top = round(x * scale), round(y * scale)
        crop = stream.render(scale=scale)[top : top + part.shape[0], left : left + part.shape[1]]
        np.testing.assert_allclose(part, crop, atol=1.1e-3, rtol=0)
