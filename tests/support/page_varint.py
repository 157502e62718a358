"""Varints, read as docs/format.md says: what the native reader is compared with."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sgicodec.errors import CorruptStreamError

__all__ = ["MAX_VARINT_BYTES", "decode_varint", "decode_varints", "read_varint"]

MAX_VARINT_BYTES = 9
_BLOCK = 1 << 16
"""Bytes of which `decode_varints` makes integers at a time."""


def read_varint(read_byte: Callable[[], int]) -> int:
    """One integer from successive bytes; `read_byte` itself raises where the bytes end.

    Raises CorruptStreamError for more than nine bytes and for a needless zero last group: every integer has
    exactly one spelling, so equal content means equal bytes.
    """
    value = 0
    for index in range(MAX_VARINT_BYTES):
        byte = read_byte()
        value |= (byte & 0x7F) << 7 * index
        if byte < 0x80:
            if byte == 0 and index > 0:
                raise CorruptStreamError("varint: padded with a zero group; the stream was not written by an encoder")
            return value
    raise CorruptStreamError("varint: longer than nine bytes; the stream is damaged")


def decode_varint(data: bytes | memoryview, offset: int = 0) -> tuple[int, int]:
    """The integer that starts at `data[offset]`, and the offset behind it. Raises CorruptStreamError as
    `read_varint`.

    >>> decode_varint(bytes.fromhex("ac02ff"))
    (300, 2)
    """
    position = offset

    def read_byte() -> int:
        nonlocal position
        if position >= len(data):
            raise CorruptStreamError(f"varint: cut short after {len(data) - offset} bytes")
        position += 1
        return data[position - 1]

    return read_varint(read_byte), position


def decode_varints(data: bytes | memoryview) -> NDArray[np.int64]:
    """All integers that `data` holds, one behind the other. Raises CorruptStreamError as `read_varint`.

    >>> decode_varints(bytes.fromhex("ac0207"))
    array([300,   7])
    """
    found, at = [], 0
    while at < len(data):
        block = np.frombuffer(data, np.uint8, min(_BLOCK, len(data) - at), at)
        last = np.flatnonzero(block < 0x80)
        if not len(last):
            raise CorruptStreamError("varint: cut short, or longer than nine bytes; the stream is damaged")
        first = np.concatenate([[0], last[:-1] + 1])
        if (last - first).max() >= MAX_VARINT_BYTES or np.any((block[last] == 0) & (last > first)):
            raise CorruptStreamError("varint: longer than nine bytes, or padded with a zero group")
        groups = block[: last[-1] + 1].astype(np.int64) & 0x7F
        place = np.arange(len(groups)) - first.repeat(last - first + 1)
        found.append(np.add.reduceat(groups << 7 * place, first))
        at += int(last[-1]) + 1
    return np.concatenate(found) if found else np.zeros(0, np.int64)
