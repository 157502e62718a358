"""A range decoder that was written from docs/format.md and shares no code with the package."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence

ROUNDING = 2.0**-8
"""Share of a symbol's bits that the coder may take more, since it divides its interval by whole numbers."""
ROUNDING_BITS = -math.log2(1 - ROUNDING)
"""The same in bits, for symbols that are nearly certain."""


class Bits:
    """Section "Range coder": the payload's bits and raw values."""

    def __init__(self, payload: bytes) -> None:
        self.payload, self.at = payload, 0
        self.range, self.offset = 2**64 - 1, self.word() << 32 | self.word()
        self.crc = 0

    def word(self) -> int:
        self.at += 4
        return int.from_bytes(self.payload[self.at - 4 : self.at].ljust(4, b"\0"), "big")

    def take(self, scale: int, below: int, frequency: int) -> None:
        self.offset -= scale * below
        self.range = scale * frequency
        assert self.offset < self.range
        if self.range < 2**32:
            self.range <<= 32
            self.offset = self.offset << 32 | self.word()

    def decode(self, frequencies: Sequence[int]) -> int:
        """A symbol of these frequencies, of 2^24 in all."""
        scale, below, symbol = self.range >> 24, 0, 0
        quantile = self.offset // scale
        while below + frequencies[symbol] <= quantile:
            below += frequencies[symbol]
            symbol += 1
        self.take(scale, below, frequencies[symbol])
        return symbol

    def bit(self, one: int) -> int:
        """A bit that is 1 with a probability of one / 2^16."""
        return self.decode((2**24 - 256 * one, 256 * one))

    def raw(self, n_bits: int) -> int:
        """A value of at most 16 bits."""
        scale = self.range >> 24
        value = self.offset // scale >> 24 - n_bits
        self.take(scale, value << 24 - n_bits, 1 << 24 - n_bits)
        return self.note(value)

    def note(self, value: int) -> int:
        """Enters the check."""
        self.crc = zlib.crc32(value.to_bytes(4, "little", signed=True), self.crc)
        return value

    def ends_well(self) -> bool:
        """Whether the check is right and nothing is left."""
        crc = self.crc
        written = self.raw(16) << 16
        written |= self.raw(16)
        return written == crc and self.at >= len(self.payload) and self.offset < 2**33 - 1
