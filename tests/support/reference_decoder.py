"""A range decoder that was written from docs/format.md and shares no code with the package."""

ROUNDING = 2.0**-8
"""Share of a symbol's bits that the coder may take more, since it divides its interval by whole numbers."""


class ReferenceDecoder:
    """The range decoder of docs/format.md, section "Range coder"."""

    def __init__(self, payload: bytes) -> None:
        self._payload = payload
        self._next = 0
        self._range = 2**64 - 1
        self._offset = self._word() << 32 | self._word()

    def decode(self, frequencies: list[int]) -> int:
        scale = self._range >> 24
        quantile = self._offset // scale
        below, symbol = 0, 0
        while below + frequencies[symbol] <= quantile:
            below += frequencies[symbol]
            symbol += 1
        self._offset -= scale * below
        self._range = scale * frequencies[symbol]
        if self._range < 2**32:
            self._range <<= 32
            self._offset = self._offset << 32 | self._word()
        return symbol

    def _word(self) -> int:
        word = self._payload[self._next : self._next + 4]
        self._next += 4
        return int.from_bytes(word + bytes(4 - len(word)), "big")
