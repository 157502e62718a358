"""Varints, read as docs/format.md says: what the native reader is compared with."""

from __future__ import annotations

from sgicodec.errors import CorruptStreamError

_MAX_BYTES = 9


def decode_varint(data: bytes | memoryview, offset: int = 0) -> tuple[int, int]:
    """The integer that starts at `data[offset]`, and the offset behind it.

    Raises CorruptStreamError where the bytes end, for more than nine bytes, and for a needless zero last group: every
    integer has exactly one spelling, so equal content means equal bytes.
    """
    value = 0
    for index in range(_MAX_BYTES):
        if offset + index >= len(data):
            raise CorruptStreamError(f"varint: cut short after {index} bytes")
        byte = data[offset + index]
        value |= (byte & 0x7F) << 7 * index
        if byte < 0x80:
            if byte == 0 and index > 0:
                raise CorruptStreamError("varint: padded with a zero group; the stream was not written by an encoder")
            return value, offset + index + 1
    raise CorruptStreamError("varint: longer than nine bytes; the stream is damaged")
