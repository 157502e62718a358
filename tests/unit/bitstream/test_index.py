"""The index: where each tile is, found from the end of a file."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.bitstream.index import TRAILER_BYTES, Place, decode_index, encode_index, index_offset
from sgicodec.errors import CorruptStreamError

END = bytes.fromhex("4500bfa9d7cc")


@given(st.lists(st.tuples(st.integers(0, 2**40), st.integers(0, 2**30)), min_size=1, max_size=9), st.integers(0, 2**40))
def test_places_come_back(pairs: list[tuple[int, int]], offset: int) -> None:
    places = [Place(*pair) for pair in pairs]
    payload = encode_index(places, offset)
    assert decode_index(payload, len(places)).tolist() == [list(place) for place in places]
    assert index_offset((payload + b"crc." + END)[-TRAILER_BYTES:]) == offset


def test_bytes() -> None:
    assert encode_index([Place(10, 300), Place(320, 5)], 400).hex(" ") == "02 0a ac 02 c0 02 05 90 01 00 00 00 00 00 00"


@pytest.mark.parametrize("tail", [b"", END, b"x" * TRAILER_BYTES, bytes(12) + b"E\0\0\0\0\0"])
def test_other_ends_have_none(tail: bytes) -> None:
    assert index_offset(tail) is None


@pytest.mark.parametrize(
    "payload", [b"", bytes(7), bytes(8), encode_index([Place(1, 2)], 3), b"\x02\x01\x01\x01" + bytes(8)]
)
def test_damage_is_found(payload: bytes) -> None:
    with pytest.raises(CorruptStreamError):
        decode_index(payload, 2)
