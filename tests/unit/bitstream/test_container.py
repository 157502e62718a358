import io
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pipe import trickle
from surgery import frame, split

from sgicodec.bitstream.container import MAX_PAYLOAD, SIGNATURE, ChunkWriter
from sgicodec.bitstream.stream_summary import StreamSummary
from sgicodec.bitstream.varint import encode_varint
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, LimitError, UnsupportedStreamError, UsageError

GOLDEN = bytes.fromhex(
    "89 53 47 49 0d 0a 1a 0a"  # signature
    "48 03 01 02 03 74 12 e9 16"  # header of three bytes, CRC
    "54 00 af 8a 0e 9f"  # empty tile, CRC
    "45 00 bf a9 d7 cc"  # end mark, CRC
)
SMALL = (Path(__file__).parents[2] / "conformance" / "golden" / "one-pixel.sgi").read_bytes()


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


HEAD, TILE = (payload for letter, payload in split(SMALL) if letter in "HT")
"""Of a stream of one pixel."""


def kinds_of(source: bytes | BinaryIO) -> dict[str, bytes]:
    """Payloads of an opened stream by the letters of their chunks."""
    with open_stream(source) as stream:
        native = stream._open_native()
        return {**native.blobs, "T": native.tile(0)}


def test_layout_is_that_of_the_format_document() -> None:
    by_hand = SIGNATURE + raw_chunk(b"H", b"\1\2\3") + raw_chunk(b"T", b"") + raw_chunk(b"E", b"")
    assert file_of(("H", b"\1\2\3"), ("T", b"")) == by_hand == GOLDEN


@pytest.mark.parametrize("source", SOURCES)
@given(st.dictionaries(st.sampled_from("sicxg"), st.binary(max_size=300)))
def test_round_trip(source: Callable[[bytes], bytes | BinaryIO], chunks: dict[str, bytes]) -> None:
    everything = {"H": HEAD, **chunks, "T": TILE}
    assert kinds_of(source(file_of(*everything.items()))) == everything


def test_what_is_not_asked_for_is_not_checked() -> None:
    damaged = bytearray(SMALL)
    damaged[damaged.index(TILE)] ^= 1
    assert StreamSummary(bytes(damaged)).chunk_bytes == StreamSummary(SMALL).chunk_bytes
    with pytest.raises(CorruptStreamError, match=f"chunk T at byte {SMALL.index(TILE) - 2}: wrong CRC"):
        open_stream(bytes(damaged))


def test_a_stream_may_start_in_the_middle_of_a_file() -> None:
    file = io.BytesIO(b"before" + SMALL)
    file.seek(6)
    assert kinds_of(file) == kinds_of(SMALL)


def test_unknown_optional_chunks_are_skipped_and_required_ones_refused() -> None:
    assert kinds_of(file_of(("H", HEAD), ("q", b"?"), ("T", TILE))) == {"H": HEAD, "T": TILE}
    with pytest.raises(UnsupportedStreamError, match=f"chunk Q at byte {len(frame('H', HEAD)) + 8} is required"):
        open_stream(file_of(("H", HEAD), ("Q", b"?")))


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("bit", range(8))
def test_every_flipped_bit_shows(source: Callable[[bytes], bytes | BinaryIO], bit: int) -> None:
    for position in range(len(SMALL)):
        damaged = bytearray(SMALL)
        damaged[position] ^= 1 << bit
        with pytest.raises(CorruptStreamError):
            open_stream(source(bytes(damaged)))


@pytest.mark.parametrize("source", SOURCES)
def test_every_cut_shows(source: Callable[[bytes], bytes | BinaryIO]) -> None:
    for length in range(len(SMALL)):
        with pytest.raises(CorruptStreamError, match=r"cut short|empty"):
            open_stream(source(SMALL[:length]))


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize(
    ("body", "message"),
    [
        (frame("T", b"") + frame("E", b""), "starts with its one header"),
        (frame("H", HEAD) + frame("H", HEAD) + frame("E", b""), "starts with its one header"),
        (frame("H", HEAD) + frame("E", b"") + b"x", "behind the end mark"),
        (frame("H", HEAD) + frame("E", b"x"), "behind the end mark"),
        (frame("H", HEAD) + b"\0\0", "starts no chunk"),
        (frame("H", HEAD) + b"T\x80\0", "zero group"),
    ],
)
def test_wrong_order_is_corrupt(source: Callable[[bytes], bytes | BinaryIO], body: bytes, message: str) -> None:
    with pytest.raises(CorruptStreamError, match=message):
        open_stream(source(SIGNATURE + body))


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
        open_stream(data)


@pytest.mark.parametrize("source", SOURCES)
def test_a_lying_length_takes_no_memory(source: Callable[[bytes], bytes | BinaryIO]) -> None:
    huge = SIGNATURE + frame("H", HEAD) + b"T" + bytes.fromhex("ffffffffffffffff7f") + b"abc"
    with pytest.raises((CorruptStreamError, LimitError)):
        open_stream(source(huge))


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
    start = SIGNATURE + frame("H", HEAD) + b"T" + encode_varint(length)
    with pytest.raises(LimitError, match=f"{length} bytes; at most {MAX_PAYLOAD}"):
        open_stream(Endless(start, len(start) + length + 10))


@pytest.mark.parametrize("chunks", [["T"], ["H", "H"], ["H", "E", "T"], ["H", "1"], ["H", "TT"], ["H", "é"]])
def test_the_writer_refuses_what_no_reader_accepts(chunks: list[str]) -> None:
    writer = ChunkWriter(io.BytesIO())
    for kind in chunks[:-1]:
        writer.write(kind, b"")
    with pytest.raises(UsageError):
        writer.write(chunks[-1], b"")
