import io
import zlib
from collections.abc import Callable
from typing import BinaryIO

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pipe import trickle

from sgicodec._native import read_chunks
from sgicodec.bitstream.container import MAX_PAYLOAD, SIGNATURE, ChunkWriter
from sgicodec.bitstream.varint import encode_varint
from sgicodec.errors import CorruptStreamError, LimitError, UnsupportedStreamError, UsageError

GOLDEN = bytes.fromhex(
    "89 53 47 49 0d 0a 1a 0a"  # signature
    "48 03 01 02 03 74 12 e9 16"  # header of three bytes, CRC
    "54 00 af 8a 0e 9f"  # empty tile, CRC
    "45 00 bf a9 d7 cc"  # end mark, CRC
)


SOURCES: list[Callable[[bytes], bytes | BinaryIO]] = [bytes, io.BytesIO, trickle]


def file_of(*chunks: tuple[str, bytes]) -> bytes:
    file = io.BytesIO()
    writer = ChunkWriter(file)
    for kind, payload in chunks:
        writer.write(kind, payload)
    writer.finish()
    assert writer.offset == len(file.getvalue())
    return file.getvalue()


def raw_chunk(kind: bytes, payload: bytes) -> bytes:
    body = kind + bytes([len(payload)]) + payload
    return body + zlib.crc32(body).to_bytes(4, "little")


def read_all(source: bytes | BinaryIO, known: str = "T") -> list[tuple[str, bytes]]:
    return read_chunks(source, known)


def test_layout_is_that_of_the_format_document() -> None:
    by_hand = SIGNATURE + raw_chunk(b"H", b"\1\2\3") + raw_chunk(b"T", b"") + raw_chunk(b"E", b"")
    assert file_of(("H", b"\1\2\3"), ("T", b"")) == by_hand == GOLDEN


@pytest.mark.parametrize("source", SOURCES)
@given(st.lists(st.tuples(st.sampled_from("TABxyz"), st.binary(max_size=300)), max_size=5), st.binary(max_size=9))
def test_round_trip(
    source: Callable[[bytes], bytes | BinaryIO], chunks: list[tuple[str, bytes]], header: bytes
) -> None:
    everything = [("H", header), *chunks]
    assert read_all(source(file_of(*everything)), "TABxyz") == everything


@pytest.mark.parametrize("source", SOURCES)
def test_payloads_can_be_skipped(source: Callable[[bytes], bytes | BinaryIO]) -> None:
    data = file_of(("H", b"head"), ("T", b"first"), ("T", b"second"))
    assert read_chunks(source(data), "T", with_payloads=False) == [("H", b""), ("T", b""), ("T", b"")]


@pytest.mark.parametrize("source", [bytes, io.BytesIO])
def test_what_is_not_asked_for_is_not_checked(source: Callable[[bytes], bytes | BinaryIO]) -> None:
    damaged = bytearray(file_of(("H", b""), ("T", b"first"), ("T", b"second")))
    damaged[damaged.index(b"first")] ^= 1
    assert len(read_chunks(source(bytes(damaged)), "T", with_payloads=False)) == 3
    with pytest.raises(CorruptStreamError, match=r"chunk T at byte 14: wrong CRC"):
        read_chunks(source(bytes(damaged)), "T")


def test_a_stream_may_start_in_the_middle_of_a_file() -> None:
    file = io.BytesIO(b"before" + GOLDEN)
    file.seek(6)
    assert read_all(file) == [("H", b"\1\2\3"), ("T", b"")]


def test_unknown_optional_chunks_are_skipped_and_required_ones_refused() -> None:
    assert read_all(file_of(("H", b""), ("q", b"?"), ("T", b"t"))) == [("H", b""), ("T", b"t")]
    with pytest.raises(UnsupportedStreamError, match="chunk Q at byte 14 is required"):
        read_all(file_of(("H", b""), ("Q", b"?")))


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("bit", range(8))
def test_every_flipped_bit_shows(source: Callable[[bytes], bytes | BinaryIO], bit: int) -> None:
    for position in range(len(GOLDEN)):
        damaged = bytearray(GOLDEN)
        damaged[position] ^= 1 << bit
        with pytest.raises(CorruptStreamError):
            read_all(source(bytes(damaged)))


@pytest.mark.parametrize("source", SOURCES)
def test_every_cut_shows(source: Callable[[bytes], bytes | BinaryIO]) -> None:
    for length in range(len(GOLDEN)):
        with pytest.raises(CorruptStreamError, match=r"cut short|empty"):
            read_all(source(GOLDEN[:length]))


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize(
    ("body", "message"),
    [
        (raw_chunk(b"T", b"") + raw_chunk(b"E", b""), "starts with its one header"),
        (raw_chunk(b"H", b"") + raw_chunk(b"H", b"") + raw_chunk(b"E", b""), "starts with its one header"),
        (raw_chunk(b"H", b"") + raw_chunk(b"E", b"") + b"x", "behind the end mark"),
        (raw_chunk(b"H", b"") + raw_chunk(b"E", b"x"), "behind the end mark"),
        (raw_chunk(b"H", b"") + b"\0\0", "starts no chunk"),
        (raw_chunk(b"H", b"") + b"T\x80\0", "zero group"),
    ],
)
def test_wrong_order_is_corrupt(source: Callable[[bytes], bytes | BinaryIO], body: bytes, message: str) -> None:
    with pytest.raises(CorruptStreamError, match=message):
        read_all(source(SIGNATURE + body))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "empty"),
        (b"\x89SG", "cut short"),
        (b"\xff\xd8\xff\xe0\0\x10JFIF", "a JPEG file"),
        (b"\x89PNG\r\n\x1a\n\0\0", "a PNG file"),
        (b"\x01\xda\x01\x01\0\x03\0\x80", "Silicon Graphics"),
        (b"\x89SGI\n\x1a\nH\0", "text mode"),
        (b"\x89SGI\r\r\n\x1a\r\n", "text mode"),
        (b"\x09SGI\r\n\x1a\n", "text mode"),
        (b"\xc2\x89SGI\r\n\x1a\n", "text mode"),
        (b"\xef\xbf\xbdSGI\r\n\x1a\n", "text mode"),
        (b"something else", "starts with 73 6f 6d"),
    ],
)
def test_foreign_files_are_named(data: bytes, message: str) -> None:
    with pytest.raises(CorruptStreamError, match=message):
        read_chunks(data, "T")


@pytest.mark.parametrize("source", SOURCES)
def test_a_lying_length_takes_no_memory(source: Callable[[bytes], bytes | BinaryIO]) -> None:
    huge = SIGNATURE + raw_chunk(b"H", b"") + b"T" + bytes.fromhex("ffffffffffffffff7f") + b"abc"
    with pytest.raises((CorruptStreamError, LimitError)):
        read_all(source(huge))


class Endless(io.RawIOBase):
    """A file of many zeros behind its start."""

    def __init__(self, start: bytes, size: int) -> None:
        self._start, self._size, self._at = start, size, 0

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        self._at = offset + (self._size if whence == io.SEEK_END else 0)
        return self._at

    def read(self, size: int = -1) -> bytes:
        found = self._start[self._at : self._at + size].ljust(min(size, self._size - self._at), b"\0")
        self._at += len(found)
        return found


def test_payloads_above_the_cap_are_refused() -> None:
    length = MAX_PAYLOAD + 1
    start = SIGNATURE + raw_chunk(b"H", b"") + b"T" + encode_varint(length)
    with pytest.raises(LimitError, match=f"{length} bytes; at most {MAX_PAYLOAD}"):
        read_all(Endless(start, len(start) + length + 10))


@pytest.mark.parametrize("chunks", [["T"], ["H", "H"], ["H", "E", "T"], ["H", "1"], ["H", "TT"], ["H", "é"]])
def test_the_writer_refuses_what_no_reader_accepts(chunks: list[str]) -> None:
    writer = ChunkWriter(io.BytesIO())
    for kind in chunks[:-1]:
        writer.write(kind, b"")
    with pytest.raises(UsageError):
        writer.write(chunks[-1], b"")
