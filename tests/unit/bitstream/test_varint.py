import pytest
from hypothesis import given
from hypothesis import strategies as st
from page_varint import decode_varint

from sgicodec.bitstream.varint import MAX_VARINT, encode_varint
from sgicodec.errors import CorruptStreamError


@pytest.mark.parametrize(
    ("value", "spelling"),
    [
        (0, "00"),
        (127, "7f"),
        (128, "8001"),
        (300, "ac02"),
        (624485, "e58e26"),
        (MAX_VARINT, "ffffffffffffffff7f"),
    ],
)
def test_known_spellings(value: int, spelling: str) -> None:
    assert encode_varint(value).hex() == spelling
    assert decode_varint(bytes.fromhex(spelling)) == (value, len(spelling) // 2)


@given(st.integers(0, MAX_VARINT), st.binary(max_size=3))
def test_round_trip_stops_at_its_end(value: int, behind: bytes) -> None:
    spelling = encode_varint(value)
    assert decode_varint(b"\xff" + spelling + behind, 1) == (value, 1 + len(spelling))


@pytest.mark.parametrize(
    ("data", "message"),
    [("", "cut short"), ("80", "cut short"), ("8000", "zero group"), ("ff" * 9 + "01", "longer than nine")],
)
def test_bad_spellings_are_corrupt(data: str, message: str) -> None:
    with pytest.raises(CorruptStreamError, match=message):
        decode_varint(bytes.fromhex(data))
