import io
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pipe import trickle
from surgery import join, split

from sgicodec.bitstream.container import ChunkWriter
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, UsageError

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


HEAD, TILE = (payload for letter, payload in split(SMALL) if letter in "HT")
"""Of a stream of one pixel."""


def kinds_of(source: bytes | BinaryIO) -> dict[str, bytes]:
    """Payloads of an opened stream by the letters of their chunks."""
    with open_stream(source) as stream:
        native = stream._open_native()
        return {**native.blobs, "T": native.tile(0)}


def test_layout_is_that_of_the_format_document() -> None:
    chunks = [("H", b"\1\2\3"), ("T", b"")]
    assert file_of(*chunks) == join([*chunks, ("E", b"")]) == GOLDEN


@pytest.mark.parametrize("source", SOURCES)
@given(st.dictionaries(st.sampled_from("sicxg"), st.binary(max_size=300)))
def test_round_trip(source: Callable[[bytes], bytes | BinaryIO], chunks: dict[str, bytes]) -> None:
    everything = {"H": HEAD, **chunks, "T": TILE}
    assert kinds_of(source(file_of(*everything.items()))) == everything


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


@pytest.mark.parametrize("chunks", [["T"], ["H", "H"], ["H", "E", "T"], ["H", "1"], ["H", "TT"], ["H", "é"]])
def test_the_writer_refuses_what_no_reader_accepts(chunks: list[str]) -> None:
    writer = ChunkWriter(io.BytesIO())
    for kind in chunks[:-1]:
        writer.write(kind, b"")
    with pytest.raises(UsageError):
        writer.write(chunks[-1], b"")
