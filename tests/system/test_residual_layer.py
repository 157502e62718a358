"""Residual layers: every sample back, or within what was asked for; alone, in regions, added later and taken off."""

from __future__ import annotations

import io
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import reference_residual
from numpy.typing import NDArray
from scenes import ISAS
from surgery import join, split

from sgicodec import EncodeSettings, Picture, _native, encode_picture, read
from sgicodec.bitstream.header import encode_header
from sgicodec.bitstream.rewriting import rewrite_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.residual import residual_layer
from sgicodec.errors import CorruptStreamError, PictureError, StreamError, UsageError

DATA = Path(__file__).parents[1] / "data"
QUICK = EncodeSettings(steps=20, quality=40, tune="psnr")
LOSSLESS = replace(QUICK, max_error=0)


def photo(width: int, height: int) -> NDArray[np.uint8]:
    return np.ascontiguousarray(read(DATA / "kodim23.png").pixels[:height, :width])


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
    return {
        "rgb8": Picture(pixels, "rgb", (0.0, 255.0)),
        "gray8": Picture(pixels[..., :1], "gray", (0.0, 255.0)),
        "rgba8": Picture(alpha, "rgba", (0.0, 255.0)),
        "gray16+alpha": Picture(deep[..., :2], "gray+alpha", (0.0, 65535.0)),
        "twelve bits": twelve,
        "noise16": Picture(rng.integers(0, 65536, (40, 33, 3)).astype(np.uint16), "rgb", (0.0, 65535.0)),
        "nodata": Picture(blank, "multi", (1.0, 65535.0), blank=0.0),
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
        np.testing.assert_array_equal(stream.picture().pixels, KINDS[name].pixels)


@pytest.mark.parametrize("name", [name for name in KINDS if name != "nodata"])
@pytest.mark.parametrize("most", [1, 4])
def test_no_sample_is_off_by_more(name: str, most: int) -> None:
    picture = KINDS[name]
    data = encode_picture(picture, replace(QUICK, max_error=most)).data
    assert len(data) < len(encode_picture(picture, LOSSLESS).data)
    with open_stream(data) as stream:
        assert stream.max_error == most
        off = np.abs(stream.picture().pixels.astype(int) - picture.pixels)
    colours = off if picture.alpha is None else off[..., : picture.alpha]
    assert colours.max() <= most
    assert picture.alpha is None or off[..., picture.alpha].max() == 0


@pytest.fixture(scope="module")
def wide() -> Picture:
    """Two blocks across and two down, in tiles."""
    pixels = np.tile(photo(300, 270), (2, 2, 1))[:530, :590]
    return Picture(np.ascontiguousarray(pixels), "rgb", (0.0, 255.0))


@pytest.fixture(scope="module")
def exact(wide: Picture) -> bytes:
    return encode_picture(wide, replace(LOSSLESS, tile=256, overview=True)).data


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
    class Pipe(io.BytesIO):
        def seekable(self) -> bool:
            return False

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


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize("threads", [1, 3])
def test_on_every_instruction_set(wide: Picture, exact: bytes, isa: str, threads: int) -> None:
    with open_stream(exact, Device(threads, isa)) as stream:
        np.testing.assert_array_equal(stream.picture().pixels, wide.pixels)


def test_it_is_taken_off_and_added_again(wide: Picture, exact: bytes) -> None:
    lossy, again = io.BytesIO(), io.BytesIO()
    rewrite_stream(io.BytesIO(exact), lossy, None)
    assert lossy.getvalue() == encode_picture(wide, replace(QUICK, tile=256, overview=True)).data
    with open_stream(lossy.getvalue()) as stream:
        layer = residual_layer(stream, windows_of(wide), 0, Device(2))
    assert rewrite_stream(lossy, again, layer) == len(exact)
    assert again.getvalue() == exact


def test_a_layer_for_another_picture_is_refused(wide: Picture, exact: bytes) -> None:
    other = replace(wide, pixels=wide.pixels[:, :-1])
    with open_stream(exact) as stream, pytest.raises(PictureError, match="589×530 pixels"):
        residual_layer(stream, windows_of(other), 0, Device(1))


def test_what_has_no_layer_is_refused() -> None:
    floats = Picture(photo(40, 30).astype(np.float32), "rgb", (0.0, 255.0))
    with pytest.raises(UsageError, match="32-bit floats"):
        encode_picture(floats, LOSSLESS)
    with pytest.raises(UsageError, match="nodata"):
        encode_picture(KINDS["nodata"], replace(QUICK, max_error=1))
    with pytest.raises(UsageError, match="0 to 254 levels"):
        encode_picture(KINDS["rgb8"], replace(QUICK, max_error=255))
    with pytest.raises(UsageError, match="must not be negative"):
        EncodeSettings(max_error=-1)


def altered(data: bytes, change: bytes) -> bytes:
    """The stream with another payload of its residual layer, and checksums that fit."""
    return join([(letter, change if letter == "r" else payload) for letter, payload in split(data)])


def test_damage_is_found() -> None:
    picture = KINDS["rgb8"]
    data = encode_picture(picture, LOSSLESS).data
    layer = dict(split(data))["r"]
    rng = np.random.default_rng(3)
    for _ in range(60):
        at = int(rng.integers(len(layer)))
        bad = bytearray(layer)
        bad[at] ^= 1 << int(rng.integers(8))
        with pytest.raises(StreamError), open_stream(altered(data, bytes(bad))) as stream:
            stream.picture()
    for bad in (b"", layer[:3], layer[:-1], layer + b"x", b"\xff" + layer[1:]):
        with pytest.raises(CorruptStreamError), open_stream(altered(data, bad)) as stream:
            stream.picture()
    for bad in (b"", layer[:-1]):  # what is left of the file can be seen
        with open_stream(altered(data, bad)) as stream:
            stream.lossy = True
            assert stream.picture().pixels.shape == picture.pixels.shape


def test_lies_of_a_layer_are_refused() -> None:
    """A layer of floats; a greatest error that no sample has; a layer behind the tile, or a second one."""
    data = encode_picture(KINDS["gray8"], LOSSLESS).data
    parts = split(data)
    layer = dict(parts)["r"]
    floats = encode_picture(Picture(photo(96, 64)[..., :1].astype(np.float32), "gray", (0.0, 255.0)), QUICK).data
    late = [part for part in split(floats) if part[0] in "Hs"] + [("r", layer)] + split(floats)[2:]
    with pytest.raises(CorruptStreamError, match="floats"), open_stream(join(late)) as stream:
        _ = stream.max_error
    with (
        pytest.raises(CorruptStreamError, match="greatest error"),
        open_stream(altered(data, b"\xff\x01" + layer[1:])) as stream,
    ):
        _ = stream.max_error
    twice = [parts[0], ("r", layer), *parts[1:]]
    with pytest.raises(CorruptStreamError, match="only one"):
        open_stream(join(twice))


@pytest.mark.parametrize(("name", "most"), [("rgb8", 0), ("rgba8", 2), ("twelve bits", 0), ("seven bands", 1)])
def test_it_is_as_the_page_of_the_format_says(name: str, most: int) -> None:
    """Probabilities and samples, by an implementation of the page."""
    whole = KINDS[name]
    part = slice(20, 41), slice(10, 61)
    picture = replace(whole, pixels=np.ascontiguousarray(whole.pixels[part]))
    with open_stream(encode_picture(picture, QUICK).data) as stream:
        drawn, header = stream.picture().pixels.astype(np.uint16), stream.header
    samples = picture.pixels.astype(np.uint16)
    bits, ones, crc = _native.code_residual(samples, drawn, encode_header(header), most)
    expected = iter(zip(bits.tolist(), ones.tolist(), strict=True))

    def code(one: int) -> int:
        bit, stated = next(expected)
        assert one == stated
        return int(bit)

    order = list(range(samples.shape[2]))
    if picture.channels.startswith("rgb"):
        order[:2] = 1, 0
    steps = [1 if c == picture.alpha else 2 * most + 1 for c in order]
    found = reference_residual.block(drawn, order, steps, int(np.iinfo(whole.pixels.dtype).max), code)
    assert next(expected, None) is None
    assert zlib.crc32(found.astype("<u2").tobytes()) == crc
    assert np.abs(found.astype(int) - samples).max() <= most
