"""A source of bytes that can only be read on."""

from __future__ import annotations

import io
from typing import BinaryIO

__all__ = ["Pipe", "trickle"]


class Pipe(io.RawIOBase):
    """Bytes that cannot be sought in. most: how many one read gives, -1 for as many as it asks for."""

    def __init__(self, data: bytes, most: int = -1) -> None:
        self._data, self._most = io.BytesIO(data), most

    def read(self, size: int = -1) -> bytes:
        return self._data.read(size if self._most < 0 else min(size, self._most))

    def seekable(self) -> bool:
        return False


def trickle(data: bytes) -> BinaryIO:
    """A pipe that gives at most three bytes at a time."""
    return Pipe(data, most=3)  # type: ignore[return-value]
