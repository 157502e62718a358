"""Damaged and forged streams of several tiles: the right picture, or an error."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import crop
from page_varint import decode_varint
from surgery import flipped, join, split

from sgicodec import EncodeSettings, encode_picture
from sgicodec.bitstream.container import SIGNATURE
from sgicodec.bitstream.index import Place, encode_index
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, StreamError


@pytest.fixture(scope="module")
def data() -> bytes:
    """96×64 pixels in two tiles."""
    return encode_picture(crop("kodim23", np.s_[180:244, 100:196]), EncodeSettings(steps=10, tile=64)).data


def test_every_flipped_byte_is_found(data: bytes) -> None:
    for bit in range(0, 8 * len(data), 61):
        with pytest.raises(StreamError):
            open_stream(flipped(data, bit)).picture()


def test_every_cut_is_found(data: bytes) -> None:
    for end in range(0, len(data), 23):
        with pytest.raises(StreamError):
            open_stream(data[:end])


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
    _, at = _places(data)
    chunks = [
        ("X", encode_index(places, at)) if letter == "X" else (letter, payload) for letter, payload in split(data)
    ]
    return join(chunks)


def test_an_index_that_lies_is_found(data: bytes) -> None:
    (first, second), index = _places(data)
    assert _with_index(data, [first, second]) == data
    lies = [
        [second, first],
        [first, first],
        [first, second._replace(length=second.length - 1)],
        [first, second._replace(offset=second.offset + 1)],
        [first, Place(index, 20)],
        [first, Place(10**12, second.length)],
    ]
    for places in lies:
        with pytest.raises(CorruptStreamError):
            open_stream(_with_index(data, places)).picture()
