"""A remote file as a binary file object: blocks are fetched when they are read, and some of them kept."""

from __future__ import annotations

import io
import os
from collections import OrderedDict
from collections.abc import Callable, Iterable
from itertools import islice
from typing import Any

BLOCK = 1 << 15
"""Bytes that ranges are aligned to: what a header and a tile of 0.2 bits per pixel take."""

_KEPT = 1 << 10
"""Blocks that are kept."""

_GAP = 1
"""Blocks that are fetched though nobody expects them, if two requests become one so."""

_MAX_AHEAD = 1 << 22
"""Bytes that are fetched at most beyond what is asked for."""

Span = tuple[int, int]
"""A first byte, and the one behind the last."""

Fetch = Callable[[list[Span]], list[bytes]]
"""Gives the bytes of spans, all of them; of several at the same time where it can."""


class RangeFile(io.RawIOBase):
    """A file of `size` bytes that `fetch` gives parts of.

    Each read is one request for what it misses; what `expect` is told of is there already. From the fourth request on
    that goes on where the one before ended, it fetches as much again ahead: a file that is read from end to end takes
    few requests, one of which parts are read costs few bytes.
    """

    def __init__(self, size: int, fetch: Fetch, close: Callable[[], None] = lambda: None) -> None:
        super().__init__()
        self._size, self._fetch, self._end = size, fetch, close
        self._position = 0
        self._blocks: OrderedDict[int, bytes] = OrderedDict()
        self._next, self._requests, self._bytes = -1, 0, 0
        """Of the current run of requests: the block after it, how many they are, and their bytes."""

    def readable(self) -> bool:
        """Always."""
        return True

    def seekable(self) -> bool:
        """Always."""
        return True

    def tell(self) -> int:
        """Where the next read begins."""
        return self._position

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """As of any file; nothing is fetched."""
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._position, os.SEEK_END: self._size}[whence]
        self._position = max(0, start + offset)
        return self._position

    def readinto(self, buffer: Any) -> int:
        """Reads as many bytes as there are and as fit."""
        view = memoryview(buffer).cast("B")
        start, stop = self._position, min(self._position + len(view), self._size)
        if start >= stop:
            return 0
        blocks = self._read(start // BLOCK, (stop - 1) // BLOCK)
        first = start - start % BLOCK
        for number, block in enumerate(blocks):
            at = first + number * BLOCK
            low, high = max(start, at), min(stop, at + len(block))
            view[low - start : high - start] = block[low - at : high - at]
        self._position = stop
        return stop - start

    def expect(self, ranges: Iterable[Span]) -> None:
        """Fetches at once what is missing of ranges (first byte, number of bytes) that are read next."""
        numbers = (
            number
            for offset, count in ranges
            for number in range(offset // BLOCK, (min(offset + count, self._size) - 1) // BLOCK + 1)
        )
        missing = set(islice(numbers, _KEPT // 2))
        runs: list[list[int]] = []
        for number in sorted(missing - self._blocks.keys()):
            if runs and number - runs[-1][-1] <= _GAP + 1:
                runs[-1].append(number)
            else:
                runs.append([number])
        spans = [(run[0] * BLOCK, min((run[-1] + 1) * BLOCK, self._size)) for run in runs]
        for (start, _), data in zip(spans, self._fetch(spans) if spans else [], strict=True):
            self._keep(start, data)

    def close(self) -> None:
        """Closes what it reads from."""
        if not self.closed:
            self._blocks.clear()
            self._end()
        super().close()

    def _read(self, first: int, last: int) -> list[bytes]:
        """Blocks `first` to `last`, fetched or kept."""
        missing = [number for number in range(first, last + 1) if number not in self._blocks]
        if missing:
            self._load(missing[0], missing[-1] + 1)
        found = [self._blocks[number] for number in range(first, last + 1)]
        for number in range(first, last + 1):
            self._blocks.move_to_end(number)
        while len(self._blocks) > _KEPT:
            self._blocks.popitem(last=False)
        return found

    def _load(self, first: int, stop: int) -> None:
        """Fetches blocks `first` to before `stop`, and those ahead."""
        if first != self._next:
            self._requests = self._bytes = 0
        start, end = first * BLOCK, min(stop * BLOCK, self._size)
        if self._requests > 2:
            end = min(end + min(self._bytes // BLOCK * BLOCK, _MAX_AHEAD), self._size)
        (data,) = self._fetch([(start, end)])
        self._next, self._requests, self._bytes = -(-end // BLOCK), self._requests + 1, self._bytes + len(data)
        self._keep(start, data)

    def _keep(self, start: int, data: bytes) -> None:
        for at in range(0, len(data), BLOCK):
            self._blocks[(start + at) // BLOCK] = data[at : at + BLOCK]
