"""Unsigned LEB128 integers: seven bits per byte, least significant group first, top bit = "more follows".

Lengths and counts in a stream are small most of the time; one byte then says what four would.
"""

from __future__ import annotations

from sgicodec.errors import UsageError

MAX_VARINT = 2**63 - 1
"""Largest value: every reader can hold it in a signed 64-bit integer."""


def encode_varint(value: int) -> bytes:
    """The shortest LEB128 bytes of 0 ≤ value ≤ MAX_VARINT, else UsageError.

    >>> encode_varint(300).hex()
    'ac02'
    """
    if not 0 <= value <= MAX_VARINT:
        raise UsageError(f"varint: {value} is outside 0..{MAX_VARINT}")
    groups = bytearray()
    while value > 0x7F:
        groups.append(value & 0x7F | 0x80)
        value >>= 7
    groups.append(value)
    return bytes(groups)
