import pytest
from hypothesis import given
from hypothesis import strategies as st
from page_varint import decode_varint, decode_varints

from sgicodec.bitstream.varint import MAX_VARINT, encode_varint
from sgicodec.errors import CorruptStreamError, UsageError


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


@pytest.mark.parametrize("value", [-1, MAX_VARINT + 1])
def test_values_out_of_range_are_refused(value: int) -> None:
    with pytest.raises(UsageError, match="outside"):
        encode_varint(value)


@pytest.mark.parametrize(
    ("data", "message"),
    [("", "cut short"), ("80", "cut short"), ("8000", "zero group"), ("ff" * 9 + "01", "longer than nine")],
)
def test_bad_spellings_are_corrupt(data: str, message: str) -> None:
    with pytest.raises(CorruptStreamError, match=message):
        decode_varint(bytes.fromhex(data))


@given(st.lists(st.integers(0, MAX_VARINT)))
def test_many_at_once(values: list[int]) -> None:
    assert decode_varints(b"".join(map(encode_varint, values))).tolist() == values


@pytest.mark.parametrize("data", ["80", "0180", "8000", "05" + "ff" * 9 + "01", "ff" * 20])
def test_many_are_refused_like_one(data: str) -> None:
    with pytest.raises(CorruptStreamError):
        decode_varints(bytes.fromhex(data))
