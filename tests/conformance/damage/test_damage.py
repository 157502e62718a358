"""Streams that lost or changed bytes: each decodes to the same picture or says that it does not."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from absurd import absurd_stream
from data_files import crop
from page_varint import decode_varint
from pipe import Pipe
from surgery import HEADER_FIELDS, flipped, join, split, with_fields

from sgicodec import EncodeSettings, SgiError, encode_picture
from sgicodec.bitstream.container import SIGNATURE
from sgicodec.bitstream.index import Place, encode_index
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, StreamError

pytestmark = pytest.mark.filterwarnings("error")


def outcome(data: bytes) -> np.ndarray | SgiError:
    """The samples, or the error that was raised on the way to them."""
    try:
        with open_stream(data) as stream:
            return stream.picture().pixels
    except SgiError as error:
        return error


def spread(count: int, tries: int) -> Iterable[int]:
    """About `tries` of the numbers below `count`, the first and the last among them."""
    return sorted({round(i * (count - 1) / (tries - 1)) for i in range(tries)})


def test_sound_stream(coded: Any) -> None:
    np.testing.assert_array_equal(outcome(coded.data), coded.pixels)
    assert join(split(coded.data)) == coded.data


def test_every_flipped_bit_is_found(coded: Any) -> None:
    bits = 8 * len(coded.data)
    for bit in spread(bits, min(bits, 12_000)):
        assert isinstance(outcome(flipped(coded.data, bit)), StreamError), bit


def test_every_cut_is_found(coded: Any) -> None:
    for length in spread(len(coded.data), min(len(coded.data), 4000)):
        assert isinstance(outcome(coded.data[:length]), CorruptStreamError), length


def test_cuts_are_found_in_pipes_too(coded: Any) -> None:
    def read(data: bytes) -> np.ndarray:
        with open_stream(Pipe(data)) as stream:
            return stream.picture().pixels

    np.testing.assert_array_equal(read(coded.data), coded.pixels)
    for length in spread(len(coded.data), 300):
        with pytest.raises(CorruptStreamError):
            read(coded.data[:length])


def test_bytes_too_many_are_found(coded: Any) -> None:
    for extra in (b"\0", b"E", coded.data):
        assert isinstance(outcome(coded.data + extra), CorruptStreamError)


def test_changed_payloads_with_fitting_checksums(coded: Any) -> None:
    """The chunk's CRC is right, so that the tile's own check and the range coder must tell."""
    parts = split(coded.data)
    tile = parts[3][1]
    found = 0
    for bit in spread(8 * len(tile), 250):
        result = outcome(join([*parts[:3], ("T", flipped(tile, bit)), parts[4]]))
        found += isinstance(result, StreamError)
        assert isinstance(result, StreamError) or np.array_equal(result, coded.pixels), bit
    assert found > 200
    for length in spread(len(tile), 120):
        result = outcome(join([*parts[:3], ("T", tile[:length]), parts[4]]))
        assert isinstance(result, StreamError) or (length == len(tile) and np.array_equal(result, coded.pixels))
    for extra in (b"\0", bytes(range(1, 13)), tile):
        assert isinstance(outcome(join([*parts[:3], ("T", tile + extra), parts[4]])), CorruptStreamError)


def test_forged_headers_with_fitting_checksums(coded: Any) -> None:
    """A header that says something else makes another picture or none, but no other trouble."""
    parts = split(coded.data)
    header = parts[0][1]
    for bit in range(8 * len(header)):
        _expect_picture_or_error(join([("H", flipped(header, bit)), *parts[1:]]))
    for length in range(len(header)):
        assert isinstance(outcome(join([("H", header[:length]), *parts[1:]])), StreamError)
    assert isinstance(outcome(join([("H", header + b"\1"), *parts[1:]])), StreamError)


@pytest.mark.parametrize("field", HEADER_FIELDS)
def test_every_header_field_may_be_anything(coded: Any, field: str) -> None:
    for value in (0, 1, 2, 3, 5, 64, 100, 255, 4096, 2**14, 2**20, 2**24, 2**31, 2**32 + 1, 2**63 - 1):
        _expect_picture_or_error(with_fields(coded.data, **{field: value}))


def _expect_picture_or_error(data: bytes) -> None:
    with contextlib.suppress(StreamError), open_stream(data) as stream:
        corner = (0, 0, min(stream.width, 32), min(stream.height, 32))
        pixels = stream.picture(corner).pixels
        assert pixels.shape == (corner[3], corner[2], stream.header.spec.channels)


@pytest.mark.parametrize("seed", range(60))
def test_any_numbers_draw_a_picture(seed: int) -> None:
    """Streams that are sound and mean nonsense draw finite pictures, without a warning and at any scale."""
    with open_stream(absurd_stream(np.random.default_rng(seed))) as stream:
        for size in (None, (33, 20), (300, 500)):
            assert np.isfinite(stream.render(size=size)).all()
            width, height = size or (stream.width, stream.height)
            assert stream.picture(size=size).pixels.shape == (height, width, stream.header.spec.channels)


@pytest.fixture(scope="module")
def tiled() -> bytes:
    """96×64 pixels in two tiles."""
    return encode_picture(crop("kodim23", np.s_[180:244, 100:196]), EncodeSettings(steps=10, tile=64)).data


def test_damage_of_tiles_is_found(tiled: bytes) -> None:
    for bit in range(0, 8 * len(tiled), 61):
        assert isinstance(outcome(flipped(tiled, bit)), StreamError), bit
    for end in range(0, len(tiled), 23):
        with pytest.raises(StreamError):
            open_stream(tiled[:end])


def _places(data: bytes) -> tuple[list[Place], int]:
    """Where the tiles are, and where the index is."""
    places, at = [], len(SIGNATURE)
    while data[at : at + 1] != b"X":
        length, start = decode_varint(data, at + 1)
        if data[at : at + 1] == b"T":
            places.append(Place(at, length))
        at = start + length + 4
    return places, at


def _with_index(data: bytes, places: list[Place]) -> bytes:
    *parts, _, end = split(data)
    return join([*parts, ("X", encode_index(places, _places(data)[1])), end])


def test_an_index_that_lies_is_found(tiled: bytes) -> None:
    (first, second), index = _places(tiled)
    assert _with_index(tiled, [first, second]) == tiled
    lies = [
        [second, first],
        [first, first],
        [first, second._replace(length=second.length - 1)],
        [first, second._replace(offset=second.offset + 1)],
        [first, Place(index, 20)],
        [first, Place(10**12, second.length)],
    ]
    for places in lies:
        assert isinstance(outcome(_with_index(tiled, places)), CorruptStreamError)
