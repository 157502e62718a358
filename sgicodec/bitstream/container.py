"""The outer layer of a file: a signature, then chunks.

A chunk is one letter, the payload's length as a varint, the payload, and a CRC-32 of all of that: seven bytes
around a small payload. The first chunk is the header H, the last one the empty end mark E. Native code reads it.
"""

from __future__ import annotations

import zlib
from typing import BinaryIO

from sgicodec._native import MAX_PAYLOAD, SIGNATURE
from sgicodec.bitstream.varint import encode_varint
from sgicodec.errors import UsageError

__all__ = ["CRC_BYTES", "END", "MAX_PAYLOAD", "SIGNATURE", "ChunkWriter"]

_HEADER, END = "H", "E"

CRC_BYTES = 4
"""Behind the payload of a chunk."""


class ChunkWriter:
    """Writes a file to `file`, an open binary stream of which only `write` is used."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._last = ""
        self.offset = 0
        """Bytes written so far: where the next chunk starts."""
        self._put(SIGNATURE)

    def write(self, kind: str, payload: bytes) -> None:
        """Appends a chunk of type `kind`. Raises UsageError for what no reader would accept."""
        if len(kind) != 1 or not (kind.isascii() and kind.isalpha()):
            raise UsageError(f"container: chunk type {kind!r} is not an ASCII letter")
        if (kind == _HEADER) != (self._last == ""):
            raise UsageError(f"container: chunk {kind} out of order; {_HEADER} comes first and once")
        if self._last == END:
            raise UsageError(f"container: chunk {kind} after the end mark")
        if len(payload) > (0 if kind == END else MAX_PAYLOAD):
            raise UsageError(f"container: chunk {kind} has {len(payload)} bytes; at most {MAX_PAYLOAD} are allowed")
        head = kind.encode() + encode_varint(len(payload))
        crc = zlib.crc32(payload, zlib.crc32(head))
        self._put(head + payload + crc.to_bytes(CRC_BYTES, "little"))
        self._last = kind

    def copy(self, kind: str, chunk: bytes) -> None:
        """Appends a whole chunk as another file has it, with head and CRC."""
        self._put(chunk)
        self._last = kind

    def finish(self) -> None:
        """Writes the end mark; without it the file counts as cut short."""
        self.write(END, b"")

    def _put(self, data: bytes) -> None:
        self._file.write(data)
        self.offset += len(data)
