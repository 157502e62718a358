"""The index: where each tile is, found from the end of a file."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from page_stream import TRAILER_BYTES, decode_index, index_offset

from sgicodec.bitstream.index import Place, encode_index

END = bytes.fromhex("4500bfa9d7cc")


@given(st.lists(st.tuples(st.integers(0, 2**40), st.integers(0, 2**30)), min_size=1, max_size=9), st.integers(0, 2**40))
def test_places_come_back(pairs: list[tuple[int, int]], offset: int) -> None:
    places = [Place(*pair) for pair in pairs]
    payload = encode_index(places, offset)
    assert decode_index(payload, len(places)).tolist() == [list(place) for place in places]
    assert index_offset((payload + b"crc." + END)[-TRAILER_BYTES:]) == offset


def test_bytes() -> None:
    assert encode_index([Place(10, 300), Place(320, 5)], 400).hex(" ") == "02 0a ac 02 c0 02 05 90 01 00 00 00 00 00 00"
