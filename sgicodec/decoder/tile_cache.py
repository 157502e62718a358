"""The tiles of a stream as they are needed: decoded once, several at a time, kept while there is room."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from sgicodec._native import resolve_threads
from sgicodec.bitstream.stream_reader import OpenedChunks
from sgicodec.decoder.tile_renderer import DrawnTile
from sgicodec.decoder.view import View
from sgicodec.errors import StreamError

if TYPE_CHECKING:
    from concurrent.futures import Executor, Future

__all__ = ["KEPT_BYTES", "KeptTiles"]

KEPT_BYTES = 1 << 28
"""What decoded tiles may take before the one that was used least recently is let go."""

_LEAST_KEPT = 4
"""Tiles that meet in a corner."""


class KeptTiles:
    """isa: the instruction set to decode with. Not safe for use by two threads at once."""

    def __init__(self, chunks: OpenedChunks, isa: str) -> None:
        self._chunks, self._isa = chunks, isa
        self._kept: OrderedDict[int, DrawnTile] = OrderedDict()
        self._ahead: _Ahead | None = None

    def __len__(self) -> int:
        return len(self._kept)

    def tile(self, number: int, threads: int) -> DrawnTile:
        """A tile, without its model if there are several. Raises CorruptStreamError or LimitError."""
        if number not in self._kept:
            coming = None if self._ahead is None else self._ahead.take(number)
            tile = self.decoded(number, threads) if coming is None else coming
            if self._chunks.header.grid.count > 1:
                tile.forget_model()
            self._kept[number] = tile
            while len(self._kept) > _LEAST_KEPT and sum(tile.memory for tile in self._kept.values()) > KEPT_BYTES:
                self._kept.popitem(last=False)
        self._kept.move_to_end(number)
        return self._kept[number]

    def decoded(self, number: int, threads: int) -> DrawnTile:
        """The same with its model, and not kept."""
        return self._decode(number, self._chunks.tile(number), threads)

    @contextmanager
    def ahead(self, numbers: Iterable[int], view: View, threads: int) -> Iterator[None]:
        """While the block asks for these tiles in this order, others work on the next of them, one thread a tile."""
        wanted = [number for number in numbers if number not in self._kept]
        threads = resolve_threads(threads)
        if threads == 1 or len(wanted) < 2:
            yield
            return
        from concurrent.futures import ThreadPoolExecutor  # takes long to load

        def decode(number: int, payload: bytes) -> DrawnTile:
            tile = self._decode(number, payload, max(1, threads // len(wanted)))
            tile.prepare(view)
            return tile

        def start(number: int) -> Future[DrawnTile]:
            return pool.submit(decode, number, self._chunks.tile(number))

        pool: Executor = ThreadPoolExecutor(min(threads, len(wanted)))
        self._ahead = _Ahead(wanted, start, threads + 1)
        try:
            yield
        finally:
            self._ahead = None
            pool.shutdown(cancel_futures=True)

    def _decode(self, number: int, payload: bytes, threads: int) -> DrawnTile:
        header = self._chunks.header
        try:
            return DrawnTile(header, payload, threads, self._isa)
        except StreamError as error:
            if header.grid.count == 1:
                raise
            raise type(error)(f"tile {number}: {error}") from error.__cause__


class _Ahead:
    """Tiles that are being decoded, at most `most` that nobody has taken."""

    def __init__(self, wanted: list[int], start: Callable[[int], Future[DrawnTile]], most: int) -> None:
        self._wanted, self._start, self._most = deque(wanted), start, most
        self._coming: dict[int, Future[DrawnTile]] = {}
        self._fill()

    def take(self, number: int) -> DrawnTile | None:
        """A tile once it is there; None for one that was not started, or was taken before."""
        found = self._coming.pop(number, None)
        self._fill()
        return None if found is None else found.result()

    def _fill(self) -> None:
        while self._wanted and len(self._coming) < self._most:
            number = self._wanted.popleft()
            self._coming[number] = self._start(number)
