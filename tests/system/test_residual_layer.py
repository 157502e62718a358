"""Residual layers: every sample back, or within what was asked for; alone, in regions, added later and taken off."""

from __future__ import annotations

import io
import math
import struct
import zlib
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import reference_residual
import tifffile
from numpy.typing import NDArray
from page_bits import opened_bits
from page_varint import decode_varint
from pipe import Pipe
from surgery import join, split
from text_pages import photo, text

from sgicodec import Device, EncodeSettings, Picture, _native, encode, encode_picture
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.rewriting import rewrite_stream
from sgicodec.bitstream.varint import encode_varint
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.residual.form import alpha_form, residual_form
from sgicodec.encoder.residual.layer import ResidualLayer, residual_payload
from sgicodec.errors import CorruptStreamError, PictureError, StreamError

QUICK = EncodeSettings(steps=20, quality=40, tune="psnr")
LOSSLESS = replace(QUICK, max_error=0)


def kinds() -> dict[str, Picture]:
    """A picture of each kind that has a residual layer."""
    rng, pixels = np.random.default_rng(5), photo(96, 64)
    deep = pixels.astype(np.uint16) * 257
    deep[..., 1] += rng.integers(0, 200, deep.shape[:2]).astype(np.uint16)
    twelve = Picture((deep >> 4).astype(np.uint16), "rgb", (0.0, 4095.0))
    blank = deep[..., [0, 1, 2, 0]].copy()
    blank[10:30, 20:50] = 0
    alpha = np.concatenate([pixels, 255 - pixels[..., :1]], axis=2)
    alpha[20:40, 30:60, 3] = 0
    heights = (1000 + photo(80, 60)[..., :1].astype(np.float32) * 3 / 10).astype(np.float32)
    holes = heights.copy()
    holes[5:20, 30:50] = -9999
    wild = np.exp(rng.normal(0, 9, (50, 40, 3))).astype(np.float32) * rng.choice([-1, 1], (50, 40, 3)).astype(
        np.float32
    )
    wild[3, 4], wild[7, 8], wild[9, 9] = np.nan, np.inf, -0.0
    spread = np.rint(pixels // 4 * 43.3).astype(np.uint16)
    few = np.sqrt(pixels // 4 * np.float32(1 / 9)) - 2
    few[:2], few[2:4] = 0.0, -0.0
    middle = pixels.copy()
    middle[middle == 100] = 101
    middle[8:20, 9:40] = 100
    return {
        "rgb8": Picture(pixels, "rgb", (0.0, 255.0)),
        "gray8": Picture(pixels[..., :1], "gray", (0.0, 255.0)),
        "rgba8": Picture(alpha, "rgba", (0.0, 255.0)),
        "gray16+alpha": Picture(deep[..., :2], "gray+alpha", (0.0, 65535.0)),
        "twelve bits": twelve,
        "noise16": Picture(rng.integers(0, 65536, (40, 33, 3)).astype(np.uint16), "rgb", (0.0, 65535.0)),
        "nodata": Picture(blank, "multi", (1.0, 65535.0), blank=0.0),
        "text": Picture(text(96, 64), "rgb", (0.0, 255.0)),
        "nodata in the middle": Picture(middle, "multi", (0.0, 255.0), blank=100.0),
        "eight bits in sixteen": Picture(pixels.astype(np.uint16) * 257, "rgb", (0.0, 65535.0)),
        "spread": Picture(spread, "multi", (0.0, 3000.0)),
        "few floats": Picture(few, "multi", (-2.0, 8.0)),
        "heights": Picture(heights, "gray", (1000.0, 1077.0)),
        "heights with holes": Picture(holes, "gray", (1000.0, 1077.0), blank=-9999.0),
        "wild floats": Picture(wild, "multi", (-100.0, 100.0), exact=True),
        "one pixel": Picture(pixels[:1, :1], "rgb", (0.0, 255.0)),
        "one column": Picture(pixels[:, :1], "rgb", (0.0, 255.0)),
        "seven bands": Picture(pixels[..., [0, 1, 2, 0, 1, 2, 0]], "multi", (0.0, 255.0)),
    }


KINDS = kinds()


@pytest.mark.parametrize("name", KINDS)
def test_every_sample_comes_back(name: str) -> None:
    data = encode_picture(KINDS[name], LOSSLESS).data
    with open_stream(data) as stream:
        assert stream.max_error == 0
        found, given = stream.picture().pixels, KINDS[name].pixels
    assert found.dtype == given.dtype
    np.testing.assert_array_equal(found, given)
    np.testing.assert_array_equal(np.signbit(found), np.signbit(given))


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("most", [1, 4])
def test_no_sample_is_off_by_more(name: str, most: int) -> None:
    picture = KINDS[name]
    data = encode_picture(picture, replace(QUICK, max_error=most)).data
    with open_stream(data) as stream:
        assert stream.max_error == most
        found = stream.picture().pixels.astype(np.float64)
    given = picture.pixels.astype(np.float64)
    is_measured = np.isfinite(given)
    np.testing.assert_array_equal(found[~is_measured], given[~is_measured])
    if picture.blank is not None:
        np.testing.assert_array_equal(found == picture.blank, given == picture.blank)
    off = np.abs(np.subtract(found, given, out=np.zeros_like(given), where=is_measured))
    assert off.max() <= most
    assert picture.alpha is None or off[..., picture.alpha].max() == 0


def test_floats_within_any_error() -> None:
    """Smaller errors take more bytes, but no more than whole tenths do; nodata stays."""
    sizes = []
    for error in (0.0001, 0.05, 0.11, 0.7, 3):
        data = encode_picture(KINDS["heights with holes"], replace(QUICK, max_error=error)).data
        with open_stream(data) as stream:
            off = np.abs(stream.picture().pixels.astype(float) - KINDS["heights with holes"].pixels)
        assert off.max() <= error
        sizes.append(len(data))
    assert sizes[0] >= sizes[1] > sizes[2] > sizes[3] > sizes[4]


def test_floats_of_which_none_was_measured() -> None:
    """A band that is all nodata, beside one that is not."""
    pixels = np.stack([np.arange(64.0).reshape(8, 8) / 3, np.zeros((8, 8))], axis=2).astype(np.float32)
    data = encode(pixels, channels="multi", nodata=0.0, max_error=1.0, effort=1)
    with open_stream(data) as stream:
        off = np.abs(stream.picture().pixels.astype(float) - pixels)
    assert off.max() <= 1
    assert off[pixels == 0].max() == 0


@pytest.mark.parametrize("factor", [257.0, 25.7])
def test_values_that_do_not_occur_take_nothing(factor: float) -> None:
    """Eight bits take the same however they are spread over sixteen or floats, but for what they are."""
    pixels = np.tile(photo(300, 270), (2, 1, 1))
    whole, lossless = np.rint(pixels * factor).astype(np.uint16), replace(LOSSLESS, restoration=False)
    floats = (pixels * factor * 2.75e-5 - 0.2).astype(np.float32)
    pictures = (
        Picture(pixels, "rgb", (0.0, 255.0)),
        Picture(whole, "rgb", (0.0, 65535.0)),
        Picture(floats, "rgb", (-0.2, 1.7)),
    )
    sizes = [len(encode_picture(picture, lossless).data) for picture in pictures]
    assert max(sizes[1:]) < 1.02 * sizes[0]


@pytest.fixture(scope="module")
def wide() -> Picture:
    """Two blocks across and two down, in tiles."""
    pixels = np.tile(photo(300, 270), (2, 2, 1))[:530, :590]
    return Picture(np.ascontiguousarray(pixels), "rgb", (0.0, 255.0))


@pytest.fixture(scope="module")
def exact(wide: Picture) -> bytes:
    return encode_picture(wide, replace(LOSSLESS, tile=256, overview=True, restoration=True)).data


def test_a_region_alone(wide: Picture, exact: bytes) -> None:
    for x, y, width, height in ((0, 0, 590, 530), (500, 505, 30, 25), (3, 520, 7, 1), (511, 511, 2, 2)):
        with open_stream(exact) as stream:
            found = stream.picture((x, y, width, height)).pixels
            np.testing.assert_array_equal(found, wide.pixels[y : y + height, x : x + width])
    with open_stream(exact) as stream:
        around = stream.picture((-5, -4, 20, 10), boundless=True).pixels
        np.testing.assert_array_equal(around[4:, 5:], wide.pixels[:6, :15])
        for top, band in stream.bands():
            np.testing.assert_array_equal(band.pixels, wide.pixels[top : top + band.height])


def test_from_a_source_that_cannot_seek(wide: Picture, exact: bytes) -> None:
    with open_stream(Pipe(exact)) as stream:
        np.testing.assert_array_equal(stream.picture().pixels, wide.pixels)


def test_other_views_are_the_lossy_pictures(exact: bytes) -> None:
    lossy = io.BytesIO()
    rewrite_stream(io.BytesIO(exact), lossy, None)
    with open_stream(exact) as stream, open_stream(lossy.getvalue()) as plain:
        assert plain.max_error is None
        for view in (
            {"scale": 0.5},
            {"region": (10, 20, 30, 40), "scale": 2.0},
            {"dtype": "uint16"},
            {"scale": 1 / 16},
        ):
            np.testing.assert_array_equal(stream.picture(**view).pixels, plain.picture(**view).pixels)
        stream.lossy = True
        np.testing.assert_array_equal(stream.picture().pixels, plain.picture().pixels)


def test_it_is_taken_off_and_added_again(wide: Picture, exact: bytes) -> None:
    lossy, again = io.BytesIO(), io.BytesIO()
    rewrite_stream(io.BytesIO(exact), lossy, None)
    assert lossy.getvalue() == encode_picture(wide, replace(QUICK, tile=256, overview=True)).data
    with open_stream(lossy.getvalue()) as stream:
        layer = residual_payload(stream, ResidualLayer(windows_of(wide), 0), Device(2))
    assert rewrite_stream(lossy, again, layer) == len(exact)
    assert again.getvalue() == exact


def test_a_layer_for_another_picture_is_refused(wide: Picture, exact: bytes) -> None:
    other = replace(wide, pixels=wide.pixels[:, :-1])
    with open_stream(exact) as stream, pytest.raises(PictureError, match="589×530 pixels"):
        residual_payload(stream, ResidualLayer(windows_of(other), 0), Device(1))


@pytest.mark.parametrize("brightest", [100, 101])
def test_colours_brighter_than_their_alpha_are_refused(brightest: int, tmp_path: Path) -> None:
    pixels = np.full((9, 12, 4), 100, np.uint8)
    pixels[3, 4, 0] = brightest
    tifffile.imwrite(tmp_path / "a.tif", pixels, photometric="rgb", extrasamples=["assocalpha"])
    encode(tmp_path / "a.tif", effort=1)
    with pytest.raises(PictureError, match="brighter than the alpha") if brightest > 100 else nullcontext():
        encode(tmp_path / "a.tif", max_error=0, effort=1)


@pytest.mark.parametrize("dtype", ["float64", "int32", "uint32"])
@pytest.mark.parametrize("sample_range", [None, (0.0, 1e9)])
def test_samples_of_too_many_bits(dtype: str, sample_range: tuple[float, float] | None, tmp_path: Path) -> None:
    """None is off by more than was asked for from what the file holds; what cannot be kept is refused."""
    samples = (photo(40, 30)[..., 0] * 3_000_001.7).astype(dtype)
    tifffile.imwrite(tmp_path / "a.tif", samples)
    with pytest.raises(PictureError, match=r"do not fit 32-bit floats, which are off by up to 3[0-2]"):
        encode(tmp_path / "a.tif", max_error=0, sample_range=sample_range)
    data = encode(tmp_path / "a.tif", max_error=40, sample_range=sample_range)
    with open_stream(data) as stream:
        off = np.abs(stream.picture().pixels[..., 0].astype(np.float64) - samples)
        assert (off.max() <= 40, stream.max_error) == (True, 40)
    tifffile.imwrite(tmp_path / "b.tif", samples // 4096 * 4096)
    with open_stream(encode(tmp_path / "b.tif", max_error=0)) as stream:
        np.testing.assert_array_equal(stream.picture().pixels[..., 0], samples // 4096 * 4096)


def test_an_array_of_too_many_bits() -> None:
    with pytest.raises(PictureError, match="do not fit 32-bit floats"):
        encode(photo(40, 30)[..., 0] / 255.0, max_error=0)


def altered(data: bytes, change: bytes) -> bytes:
    """The stream with another payload of its residual layer, and checksums that fit."""
    return join([(letter, change if letter == "r" else payload) for letter, payload in split(data)])


def test_damage_is_found() -> None:
    picture = KINDS["rgb8"]
    data = encode_picture(picture, LOSSLESS).data
    layer = dict(split(data))["r"]
    rng = np.random.default_rng(3)
    for _ in range(60):
        at = int(rng.integers(8, len(layer)))  # behind the greatest error, which nothing else says
        bad = bytearray(layer)
        bad[at] ^= 1 << int(rng.integers(8))
        with pytest.raises(StreamError), open_stream(altered(data, bytes(bad))) as stream:
            stream.picture()
    for bad in (b"", layer[:3], layer[:-1], layer + b"x", layer[:40]):
        with pytest.raises(CorruptStreamError), open_stream(altered(data, bad)) as stream:
            stream.picture()
    for bad in (b"", layer[:-1]):  # what is left of the file can be seen
        with open_stream(altered(data, bad)) as stream:
            stream.lossy = True
            assert stream.picture().pixels.shape == picture.pixels.shape


@pytest.mark.parametrize(
    ("at", "lie", "what"),
    [
        (0, struct.pack("<d", -1.0), "greatest error"),
        (0, struct.pack("<d", math.nan), "greatest error"),
        (8, b"\1", "flags"),
        (8, b"\4", "flags"),
        (8, b"\6", "palette"),
        (8, b"\12", "block"),
        (8, b"\20", "flags"),
        (8, b"\10", "flags"),
        (9, encode_varint(1 << 50), "grid"),
        (10, b"\0", "grid"),
        (10, encode_varint(300), "grid"),
        (11, encode_varint(1 << 14), "grid"),
        (13, encode_varint(200), "grid"),
        (13, b"\1\1", "table"),
        (14, b"\1", "table"),
        (14, encode_varint(1 << 20), "table"),
    ],
)
def test_lies_of_a_layer_are_refused(at: int, lie: bytes, what: str) -> None:
    data = encode_picture(KINDS["gray8"], LOSSLESS).data
    layer = dict(split(data))["r"]
    bad = altered(data, layer[:at] + lie + layer[at + len(lie) :])
    with pytest.raises(CorruptStreamError, match=what), open_stream(bad) as stream:
        stream.picture()


def test_two_layers_are_refused() -> None:
    parts = split(encode_picture(KINDS["gray8"], LOSSLESS).data)
    twice = [parts[0], ("r", dict(parts)["r"]), *parts[1:]]
    with pytest.raises(CorruptStreamError, match="only one"):
        open_stream(join(twice))


@pytest.mark.parametrize("has_cells", [False, True])
@pytest.mark.parametrize(
    ("name", "most", "repeats"),
    [
        ("rgb8", 0, 1),
        ("rgba8", 2, 1),
        ("twelve bits", 0, 1),
        ("seven bands", 1, 1),
        ("nodata in the middle", 3, 1),
        ("text", 0, 1),
        ("text", 0, 9),
        ("text", 20, 1),
        ("heights with holes", 0.05, 1),
        ("wild floats", 0, 1),
        ("spread", 0, 1),
        ("spread", 30, 1),
        ("few floats", 0, 1),
    ],
)
def test_it_is_as_the_page_of_the_format_says(name: str, most: float, repeats: int, has_cells: bool) -> None:
    """Probabilities and samples, by an implementation of the page; repeats: so large that it has a palette."""
    whole = KINDS[name]
    part = slice(2, 23), slice(2, 53)
    picture = replace(whole, pixels=np.ascontiguousarray(whole.pixels[part]))
    with open_stream(encode_picture(picture, QUICK).data) as stream:
        drawn, header = stream.picture().pixels.astype(np.float32), stream.header
    samples = picture.pixels.astype(np.float32)
    if has_cells and (header.masked or header.has_exact):
        return
    cells = np.array([1, 0, 0, 1, 1, 1, 0, 1][: len(range(2, 23, 16)) * -(-samples.shape[1] // 16)], np.uint8)
    cells |= not has_cells
    views = {"exact_views": repeats > 1 or has_cells, "has_cells": has_cells}
    form = residual_form(header, [picture.pixels] * repeats, most, **views)
    order = list(range(samples.shape[2]))
    if picture.channels.startswith("rgb"):
        order[:2] = 1, 0
    nodata = [None if c == picture.alpha else header.blank for c in range(samples.shape[2])]
    grids, at = grids_of(form, len(order), picture.pixels.dtype != np.float32)
    palette, at = palette_of(form, at, len(order)) if form[8] & 4 else ([], at)
    assert at == len(form)
    assert bool(palette) == (repeats > 1)
    assert all(grid.table for grid in grids) or most or name not in ("spread", "few floats")
    by_the_page(samples, drawn, header, form, cells, order, grids, form[8] & 1 == 1, nodata, palette, has_cells)


def test_alpha_alone_is_as_the_page_says() -> None:
    """One channel, over nothing."""
    picture = KINDS["rgba8"]
    alpha = np.ascontiguousarray(picture.pixels[2:23, 2:53, 3:], np.float32)
    with open_stream(encode_picture(picture, QUICK).data) as stream:
        header, form = replace(stream.header, width=51, height=21, masked=None), alpha_form(255)
    drawn, cells = np.zeros_like(alpha), np.ones(8, np.uint8)
    grids, at = grids_of(form, 1, is_whole=True)
    assert (at, form[8]) == (len(form), 16)
    found = by_the_page(alpha, drawn, header, form, cells, [0], grids, False, [None])
    np.testing.assert_array_equal(found, alpha)


def test_bands_alone_are_as_the_page_says() -> None:
    """As if there were no others."""
    pixels = np.random.default_rng(4).integers(0, 4, (21, 51, 3)).astype(np.uint8)
    pixels[:, 20:] = pixels[:1, 20:]
    with open_stream(encode_picture(Picture(pixels, "multi", (0.0, 255.0)), QUICK).data) as stream:
        header = stream.header
    form = residual_form(header, [pixels[..., [0, 2]]], 0, exact_views=True, bands=(0, 2))
    samples = np.ascontiguousarray(pixels[..., [0, 2]], np.float32)
    drawn, cells = samples[::-1].copy(), np.ones(8, np.uint8)
    assert form[8:12] == bytes([2 | 32, 1, 0, 1])
    grids, at = grids_of(form, 2, is_whole=True, at=12)
    assert at == len(form)
    found = by_the_page(samples, drawn, header, form, cells, [0, 1], grids, False, [None, None])
    np.testing.assert_array_equal(found, samples)


def by_the_page(
    samples: NDArray[Any], drawn: NDArray[Any], header: Header, form: bytes, cells: NDArray[Any], *given: Any
) -> NDArray[Any]:
    """A block as the page reads it from what is written. given: as to `reference_residual.block`, but for what gives a
    bit.
    """
    data, crc, _ = _native.code_residual(samples, drawn, encode_header(header), form, cells)
    decoder, code = opened_bits(data)
    order, grids, has_bits, nodata, *more = given
    found = reference_residual.block(drawn, order, grids, has_bits, nodata, code, *more)
    assert decoder.maybe_exhausted()
    assert zlib.crc32(found.astype("<f4").tobytes()) == crc
    return found


def palette_of(form: bytes, at: int, channels: int) -> tuple[list[list[int]], int]:
    count, at = decode_varint(form, at)
    values = []
    for _ in range(count * channels):
        value, at = decode_varint(form, at)
        values.append(value)
    return [values[i : i + channels] for i in range(0, len(values), channels)], at


def grids_of(form: bytes, channels: int, is_whole: bool, at: int = 9) -> tuple[list[reference_residual.Grid], int]:
    grids = []
    for _ in range(channels):
        grid, at = reference_residual.grid_of(form, at, is_whole)
        grids.append(grid)
    return grids, at
