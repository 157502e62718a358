"""Sources of bytes: one that can only be read on, one that counts what is read."""

from __future__ import annotations

import io
from typing import BinaryIO


class Pipe(io.RawIOBase):
    """Bytes that cannot be sought in. most: how many one read gives, -1 for as many as it asks for."""

    def __init__(self, data: bytes, most: int = -1) -> None:
        self._data, self._most = io.BytesIO(data), most

    def read(self, size: int = -1) -> bytes:
        return self._data.read(size if self._most < 0 else min(size, self._most))

    def seekable(self) -> bool:
        return False


class Counted(io.BytesIO):
    """Remembers how many bytes each read gave."""

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        self.reads: list[int] = []

    def read(self, size: int | None = -1, /) -> bytes:
        data = super().read(size)
        self.reads.append(len(data))
        return data


def trickle(data: bytes) -> BinaryIO:
    """A pipe that gives at most three bytes at a time."""
    return Pipe(data, most=3)  # type: ignore[return-value]
