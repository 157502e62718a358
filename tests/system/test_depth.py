"""Samples of another depth are rendered as such, not made of those of the source's."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.decoder.stream import open_stream


def sky(dtype: str) -> Picture:
    """A ramp of a few levels of eight bits over many pixels [64, 160, 3]."""
    y, x = np.mgrid[:64, :160]
    unit = np.stack([0.5 + 0.03 * x / 160, 0.6 + 0.02 * y / 64, 0.7 + 0.02 * (x + y) / 224], axis=2)
    samples = {"uint8": 255 * unit, "uint16": 65535 * unit, "float32": 100 * unit}[dtype]
    pixels = samples.astype(dtype) if dtype == "float32" else np.rint(samples).astype(dtype)
    return Picture(pixels, "rgb", (0.0, 100.0) if dtype == "float32" else (0.0, float(np.iinfo(dtype).max)))


@pytest.fixture(scope="module", params=["uint8", "uint16", "float32"])
def stream(request: pytest.FixtureRequest) -> bytes:
    return encode_picture(sky(request.param), EncodeSettings(steps=30, quality=70)).data


def blurred(pixels: np.ndarray) -> np.ndarray:
    """Means of 16 × 16 pixels."""
    return pixels.astype(np.float64).reshape(4, 16, 10, 16, 3).mean(axis=(1, 3))


def test_sixteen_bits_are_no_multiples_of_eight(stream: bytes) -> None:
    with open_stream(stream) as opened:
        exact, deep = opened.render().clip(0, 1), opened.picture(dtype="uint16").pixels
        floats = opened.picture(dtype="float32")
    assert np.abs(deep / 65535 - exact).max() < 1 / 65535
    assert np.abs(floats.pixels / floats.sample_range[1] - exact).max() < 1e-6
    assert len(np.unique(deep)) > 4 * len(np.unique(deep // 257))


def test_eight_bits_of_more_keep_the_mean_of_a_few_pixels(stream: bytes) -> None:
    with open_stream(stream) as opened:
        exact, deeper = opened.render().clip(0, 1), opened.header.sample_type != "uint8"
        found = opened.picture(dtype="uint8").pixels
        opened.dither = False
        rounded = opened.picture(dtype="uint8").pixels
    np.testing.assert_array_equal(rounded, np.rint(255 * exact))
    assert (found == rounded).all() == (not deeper)
    if deeper:
        assert np.abs(found / 255 - exact).max() < 1.01 / 255
        errors = [np.abs(blurred(pixels) - 255 * blurred(exact)).max() for pixels in (found, rounded)]
        assert errors[0] < 0.1 < errors[1]
