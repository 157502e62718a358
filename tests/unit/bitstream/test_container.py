import io

import pytest
from surgery import join

from sgicodec.bitstream.container import ChunkWriter
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, UsageError

GOLDEN = bytes.fromhex(
    "89 53 47 49 0d 0a 1a 0a"  # signature
    "48 03 01 02 03 74 12 e9 16"  # header of three bytes, CRC
    "54 00 af 8a 0e 9f"  # empty tile, CRC
    "45 00 bf a9 d7 cc"  # end mark, CRC
)


def file_of(*chunks: tuple[str, bytes]) -> bytes:
    file = io.BytesIO()
    writer = ChunkWriter(file)
    for kind, payload in chunks:
        writer.write(kind, payload)
    writer.finish()
    assert writer.offset == len(file.getvalue())
    return file.getvalue()


def test_layout_is_that_of_the_format_document() -> None:
    chunks = [("H", b"\1\2\3"), ("T", b"")]
    assert file_of(*chunks) == join([*chunks, ("E", b"")]) == GOLDEN


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
