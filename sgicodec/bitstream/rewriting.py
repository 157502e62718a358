"""A stream copied with another residual layer, or without one."""

from __future__ import annotations

import zlib
from typing import BinaryIO, NamedTuple

from sgicodec.bitstream.container import CRC_BYTES, END, MAX_PAYLOAD, SIGNATURE, ChunkWriter
from sgicodec.bitstream.index import Place, encode_index
from sgicodec.errors import CorruptStreamError

RESIDUAL = "r"
"""The letter of the chunk of a residual layer."""
_MAX_VARINT = 9
"""Bytes of a length."""


def rewrite_stream(source: BinaryIO, file: BinaryIO, residual: bytes | None) -> int:
    """Copies a stream that can be opened, with this payload of its residual layer in place of the one it has; returns
    the length. All other chunks stay byte for byte, but for the index.
    """
    source.seek(len(SIGNATURE))
    writer = ChunkWriter(file)
    places: list[Place] = []
    while (chunk := _next_chunk(source)).kind != END:
        if chunk.kind == RESIDUAL:
            continue
        if chunk.kind == "T":
            if residual is not None and not places:
                writer.write(RESIDUAL, residual)
            places.append(Place(writer.offset, chunk.length))
        if chunk.kind == "X":
            writer.write("X", encode_index(places, writer.offset))
        else:
            writer.copy(chunk.kind, chunk.whole)
    writer.finish()
    return writer.offset


class _Chunk(NamedTuple):
    """kind: its letter; length: of its payload in bytes; whole: all its bytes, with head and CRC."""

    kind: str
    length: int
    whole: bytes


def _next_chunk(source: BinaryIO) -> _Chunk:
    """Raises CorruptStreamError for one that is cut off, or has another CRC."""
    head, length, byte = source.read(1), 0, b"\x80"
    while byte >= b"\x80" and len(head) <= _MAX_VARINT:
        byte = source.read(1)
        length |= (byte[0] & 0x7F) << 7 * (len(head) - 1) if byte else 0
        head += byte
    rest = source.read(length + CRC_BYTES) if length <= MAX_PAYLOAD else b""
    crc = zlib.crc32(rest[:length], zlib.crc32(head)).to_bytes(CRC_BYTES, "little")
    if rest[length:] != crc or not head[:1].isalpha():
        raise CorruptStreamError("a chunk is damaged or cut off")
    return _Chunk(head[:1].decode(), length, head + rest)
