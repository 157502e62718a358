"""A file that slices like bytes, so that parsers of bytes can read a few places of a very large one."""

from __future__ import annotations

import os
from typing import BinaryIO, overload


class FileBytes:
    """The contents of a file opened for reading in binary. Only what is sliced is read; nothing is mapped into memory.

    Steps other than 1 are not supported. As with bytes, a slice past the end is short or empty.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._size = os.fstat(file.fileno()).st_size

    def __len__(self) -> int:
        return self._size

    @overload
    def __getitem__(self, at: int) -> int: ...
    @overload
    def __getitem__(self, at: slice) -> bytes: ...
    def __getitem__(self, at: int | slice) -> int | bytes:
        if isinstance(at, slice):
            start, stop, _ = at.indices(self._size)
            self._file.seek(start)
            return self._file.read(max(0, stop - start))
        if not -self._size <= at < self._size:
            raise IndexError(at)
        self._file.seek(at % self._size)
        return self._file.read(1)[0]


Bytes = bytes | memoryview | FileBytes
"""Anything that slices like bytes."""
