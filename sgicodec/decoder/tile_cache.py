"""The tile cache: tiles of a stream are decoded once, several at a time, and kept while there is room."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from sgicodec._native import resolve_threads
from sgicodec.bitstream.stream_reader import StreamReader
from sgicodec.decoder.tile_renderer import TileRenderer
from sgicodec.decoder.view import View
from sgicodec.device import Device
from sgicodec.errors import StreamError

if TYPE_CHECKING:
    from concurrent.futures import Executor, Future

__all__ = ["CACHE_BYTES", "TileCache"]

CACHE_BYTES = 1 << 28
"""What decoded tiles may take before the one that was used least recently is released."""

_LEAST_TILES = 4
"""Tiles that meet in a corner."""
_OVERHEAD = 1 << 14
"""Bytes that a tile counts for besides its arrays: one that holds nothing is not free."""


class TileCache:
    """What decodes them is `device`. Not safe for use by two threads at once."""

    def __init__(self, chunks: StreamReader, device: Device) -> None:
        self._stream, self._device = chunks, device
        self._tiles: OrderedDict[int, TileRenderer] = OrderedDict()
        self._bytes: dict[int, int] = {}
        self._total = 0
        self._lately: deque[int] = deque(maxlen=_LEAST_TILES)  # tiles that grew, if they were drawn since
        self._prefetch: _Prefetch | None = None

    def __len__(self) -> int:
        return len(self._tiles)

    def tile(self, number: int) -> TileRenderer:
        """A tile, without its model if there are several. Raises CorruptStreamError or LimitError."""
        if number not in self._tiles:
            coming = None if self._prefetch is None else self._prefetch.take(number)
            tile = self.decoded(number) if coming is None else coming
            if self._stream.header.grid.count > 1:
                tile.release_model()
            self._tiles[number] = tile
            self._lately.append(number)
            for changed in self._lately:
                self._weigh(changed)
            while len(self._tiles) > _LEAST_TILES and self._total > CACHE_BYTES:
                released, _ = self._tiles.popitem(last=False)
                self._weigh(released)
        self._tiles.move_to_end(number)
        return self._tiles[number]

    def _weigh(self, number: int) -> None:
        """Counts what a tile takes now, or no longer takes."""
        tile = self._tiles.get(number)
        now = 0 if tile is None else tile.memory + _OVERHEAD
        self._total += now - self._bytes.pop(number, 0)
        if tile is not None:
            self._bytes[number] = now

    def decoded(self, number: int) -> TileRenderer:
        """The same with its model, and not cached."""
        return self._decode(number, self._stream.tile(number), self._device)

    @contextmanager
    def prefetch(self, numbers: Iterable[int], view: View) -> Iterator[None]:
        """While the block asks for these tiles in this order, a pool decodes the next of them, one thread a tile."""
        wanted = [number for number in numbers if number not in self._tiles]
        threads = resolve_threads(self._device.threads)
        if threads == 1 or len(wanted) < 2:
            yield
            return
        from concurrent.futures import ThreadPoolExecutor  # takes long to load

        each = self._device.with_threads(max(1, threads // len(wanted)))

        def decode(number: int, payload: bytes) -> TileRenderer:
            tile = self._decode(number, payload, each)
            tile.prepare(view, self._device.with_threads(1))
            return tile

        def start(number: int) -> Future[TileRenderer]:
            return pool.submit(decode, number, self._stream.tile(number))

        pool: Executor = ThreadPoolExecutor(min(threads, len(wanted)))
        self._prefetch = _Prefetch(wanted, start, threads + 1)
        try:
            yield
        finally:
            self._prefetch = None
            pool.shutdown(cancel_futures=True)

    def _decode(self, number: int, payload: bytes, device: Device) -> TileRenderer:
        header = self._stream.header
        try:
            return TileRenderer(header, payload, device)
        except StreamError as error:
            if header.grid.count == 1:
                raise
            raise type(error)(f"tile {number}: {error}") from error.__cause__


class _Prefetch:
    """Tiles that are being decoded, at most `most` of them not yet taken."""

    def __init__(self, wanted: list[int], start: Callable[[int], Future[TileRenderer]], most: int) -> None:
        self._wanted, self._start, self._most = deque(wanted), start, most
        self._coming: dict[int, Future[TileRenderer]] = {}
        self._fill()

    def take(self, number: int) -> TileRenderer | None:
        """A tile once it is there; None for one that was not started, or was taken before."""
        found = self._coming.pop(number, None)
        self._fill()
        return None if found is None else found.result()

    def _fill(self) -> None:
        while self._wanted and len(self._coming) < self._most:
            number = self._wanted.popleft()
            self._coming[number] = self._start(number)
