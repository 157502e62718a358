"""Luma space: the matrices of docs/format.md, and pictures that come back in their own colours."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec import encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.luma_space import from_luma_space, to_luma_space
from sgicodec.picture import Picture

PAGE = np.array(
    [
        3**0.5 * np.array([1 / 4, 5 / 8, 1 / 8]),
        0.65 / 2**0.5 * np.array([1, 0, -1]),
        0.5 * 1.5**0.5 * np.array([-1 / 2, 5 / 4, -3 / 4]),
    ]
)


@pytest.mark.parametrize("channels", [3, 4])
def test_the_matrices_of_the_page(channels: int) -> None:
    page = np.eye(channels)
    page[:3, :3] = np.linalg.inv(PAGE) @ np.array(colour_matrix(3))
    np.testing.assert_allclose(from_luma_space(channels), page, atol=1e-12)
    np.testing.assert_allclose(to_luma_space(channels) @ page, np.eye(channels), atol=1e-12)


@pytest.mark.parametrize("colour", [(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0), (13, 200, 90)])
@pytest.mark.parametrize("channels", ["rgb", "rgba"])
def test_pure_colours_come_back(colour: tuple[int, int, int], channels: str) -> None:
    pixels = np.full((40, 56, len(channels)), 255, np.uint8)
    pixels[..., :3] = colour
    pixels[0, 0, 3:] = 254  # an alpha that is not left out
    pixels[8:30, 10:33, :3] = 255 - np.array(colour)
    data = encode_picture(Picture(pixels, channels, (0.0, 255.0)), EncodeSettings(quality=90, steps=40)).data
    with open_stream(data) as stream:
        assert stream.header.spec.luma_space
        decoded = stream.picture().pixels
        half = stream.picture(size=(28, 20)).pixels
    error = np.abs(decoded.astype(int) - pixels)
    assert np.median(error) <= 2
    assert error.mean() < 4
    assert np.abs(half[10:12, 8:12, :3].astype(int) - pixels[20, 20, :3]).max() <= 30
