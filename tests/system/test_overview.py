"""Overviews: means of pixels on one side, small views that leave the tiles alone on the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from data_files import crop
from pipe import Counted
from surgery import join, split

from sgicodec import Encoded, EncodeSettings, Picture, encode_picture
from sgicodec.bitstream.container import SIGNATURE
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.encoder.input.overview import overview_picture
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.errors import CorruptStreamError
from sgicodec.metadata import geo, ifd
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Metadata, nodata_mask

SETTINGS = EncodeSettings(quality=55, steps=60, tile=128, overview=True)


def small(picture: Picture, tile: int) -> Picture:
    """The overview's picture, from windows of such tiles."""
    plan = stream_plan(Shape.of(picture), replace(SETTINGS, tile=tile))

    def window(x: int, y: int, width: int, height: int) -> Picture:
        return replace(picture, pixels=picture.pixels[y : y + height, x : x + width])

    return overview_picture(plan, window)


def shares(pixels: int, boxes: int) -> np.ndarray:
    """What part of each box [boxes, pixels] each pixel is, one by one."""
    edge = [index * pixels / boxes for index in range(boxes + 1)]
    parts = [[max(0.0, min(i + 1, edge[b + 1]) - max(i, edge[b])) for i in range(pixels)] for b in range(boxes)]
    return np.array(parts) * boxes / pixels


@pytest.fixture(scope="module")
def photo() -> Picture:
    """336×250 pixels."""
    return crop("kodim23", np.s_[:250, 64:400])


@pytest.fixture(scope="module")
def coded(photo: Picture) -> Encoded:
    """In 3×2 tiles, with an overview of 21×16 pixels."""
    return encode_picture(photo, SETTINGS)


@pytest.mark.parametrize("tile", [64, 100, 300])
def test_its_pixels_are_means(photo: Picture, tile: int) -> None:
    """Those of 250 rows in 16 lie partly in two."""
    found = small(photo, tile).pixels
    expected = np.einsum("ij,jkc,lk->ilc", shares(250, 16), photo.pixels.astype(float), shares(336, 21))
    assert found.shape == (16, 21, 3)
    np.testing.assert_allclose(found, expected, atol=0.5 + 1e-4)


def test_colours_count_by_their_alpha() -> None:
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 65536, (96, 160, 4)).astype(np.uint16)
    pixels[:40, :50, 3] = 0
    found = small(Picture(pixels, "rgba", (0.0, 65535.0)), 64).pixels
    blocks = pixels.astype(float).reshape(6, 16, 10, 16, 4)
    alpha = blocks[..., 3:].mean(axis=(1, 3))
    colours = (blocks[..., :3] * blocks[..., 3:]).mean(axis=(1, 3)) / np.maximum(alpha, 1e-9)
    np.testing.assert_allclose(found[..., 3:], alpha, atol=0.51)
    assert (found[:2, :3, 3] == 0).all()
    seen = found[..., 3] > 0
    np.testing.assert_allclose(found[seen][:, :3], colours[seen], atol=0.51)


def test_nodata_does_not_count() -> None:
    """Nor does a pixel whose centre holds nothing hold anything; black beside it does not become nothing."""
    packed = geo.pack({42113: ifd.Entry(2, b"0\0")})
    rng = np.random.default_rng(2)
    pixels = rng.integers(1, 256, (160, 144, 1)).astype(np.uint8)
    pixels[:48, :60] = 0
    pixels[64:80, 64:80] = 0
    pixels[79, 64] = 200
    picture = Picture(pixels, "gray", (0.0, 255.0), Metadata(geo=packed))
    found = small(picture, 64)
    blocks = pixels[..., 0].astype(float).reshape(10, 16, 9, 16)
    measured = (blocks > 0).sum(axis=(1, 3))
    means = blocks.sum(axis=(1, 3)) / np.maximum(measured, 1)
    empty = (blocks == 0)[:, 8, :, 8]
    np.testing.assert_array_equal(nodata_mask(found), empty)
    np.testing.assert_allclose(found.pixels[..., 0][~empty], means[~empty], atol=0.51)


def test_small_views_draw_it_and_no_tile(coded: Encoded, photo: Picture) -> None:
    def decoded(stream: Stream) -> int:
        return stream._open_native().tiles()[1]

    stream, exact = open_stream(coded.data), open_stream(coded.data)
    shown = stream.picture(scale=1 / 16)
    assert (decoded(stream), decoded(stream.overview)) == (0, 1)
    np.testing.assert_array_equal(shown.pixels, stream.overview.picture().pixels)
    assert psnr(shown.pixels, small(photo, 128).pixels) > 24
    exact.exact = True
    whole = exact.picture(scale=1 / 16).pixels
    assert (decoded(exact), decoded(exact.overview)) == (6, 0)
    assert psnr(shown.pixels, whole) > 24
    assert stream.picture(size=(22, 16)).pixels.shape == (16, 22, 3)
    assert decoded(stream) == 6


def test_it_alone_is_read_for_them(coded: Encoded) -> None:
    source = Counted(coded.data)
    stream = open_stream(source)
    assert sum(source.reads) < 4096 + 400
    source.reads.clear()
    stream.picture(scale=1 / 16)
    assert sum(source.reads) < stream.chunk_bytes["o"] + 20


def test_a_damaged_one_spoils_small_views_alone(coded: Encoded) -> None:
    at = coded.data.index(SIGNATURE, 1) + 60
    data = bytearray(coded.data)
    data[at] ^= 4
    stream = open_stream(bytes(data))
    np.testing.assert_array_equal(stream.picture().pixels, open_stream(coded.data).picture().pixels)
    with pytest.raises(CorruptStreamError, match="CRC"):
        stream.picture(scale=1 / 16)
    stream.exact = True
    assert stream.picture(scale=1 / 16).pixels.shape == (16, 21, 3)


def test_what_is_no_overview_of_this_picture_is_refused(coded: Encoded, photo: Picture) -> None:
    gray = Picture(np.zeros((16, 21, 1), np.uint8), "gray", (0.0, 255.0))
    deep = Picture(np.zeros((16, 21, 3), np.uint16), "rgb", (0.0, 65535.0))
    one = EncodeSettings(steps=1)
    for wrong, complaint in (
        (b"no stream", "overview: no stream"),
        (encode_picture(photo, one).data, "overview: it has 336×250 pixels, not 21×16"),
        (encode_picture(gray, one).data, "overview: its channels"),
        (encode_picture(deep, one).data, "overview: its samples"),
    ):
        parts = [(letter, wrong if letter == "o" else body) for letter, body in split(coded.data) if letter != "X"]
        stream = open_stream(join(parts))
        with pytest.raises(CorruptStreamError, match=complaint):
            stream.picture(scale=1 / 16)
