"""The time budget of an encode in several tiles: each gets a share of what is left when its work begins."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable
from statistics import median
from typing import NamedTuple

from sgicodec.encoder.tiles.tasks import EncodedTile
from sgicodec.model.tile_grid import TileGrid

__all__ = ["TimeBudget"]


class _Begun(NamedTuple):
    """A tile under way: values of time.monotonic(), and the seconds assigned to it."""

    at: float
    until: float
    assigned: float


class TimeBudget:
    """Shares the time until `end`, a value of time.monotonic(), out to tiles in proportion to their weights.

    workers: how many tiles are done at once. decoders: how many threads decode the stream at the end, 0 if none does.
    weigh: what a step of a tile's fit costs, in any unit; without it all pixels weigh the same.
    What is left of all workers' time goes to the tiles that have not begun: what one tile leaves or takes beyond its
    share, the others gain or lose. A tile is assigned less than its share by the median overrun of the last tiles, more
    if they took less than was assigned to them.
    """

    def __init__(
        self, grid: TileGrid, end: float, workers: int, decoders: int, weigh: Callable[[int], float] | None = None
    ) -> None:
        self._grid, self._end, self._workers, self._decoders = grid, end, workers, decoders
        self._weigh = weigh or self._pixels
        self._weights: dict[int, float] = {}
        self._waiting: set[int] = set()
        self._begun: dict[int, _Begun] = {}
        self._overruns = deque([0.0], maxlen=_LAST)  # seconds for each unit of weight
        self._decoding = self._decoded = 0.0  # seconds, weight

    def expect(self, numbers: Iterable[int]) -> None:
        """These tiles are to be done. Weighs them."""
        self._weights = {number: self._weigh(number) for number in numbers}
        self._waiting = set(self._weights)

    def begin(self, number: int) -> float:
        """Seconds for a tile whose work begins now, perhaps once more."""
        now, weight = time.monotonic(), self._weights[number]
        self._begun.pop(number, None)
        self._waiting.add(number)
        left = max(0.0, self._end - self._ending() - now)
        taken = sum(max(0.0, begun.until - now) for begun in self._begun.values())
        share = max(0.0, self._workers * left - taken) * weight / sum(self._weights[other] for other in self._waiting)
        alike = sum(self._weights[other] >= _ALIKE * weight for other in self._waiting)
        turns = -(-alike // self._workers)
        share = min(share, left if turns == 1 else left * (1 - _RESERVED / turns))
        assigned = min(max(share - median(self._overruns) * weight, _MIN_PART * share), left)
        assigned = max(assigned, _MIN_SECONDS)
        self._waiting.remove(number)
        self._begun[number] = _Begun(now, now + share, assigned)
        return assigned

    def done(self, number: int, tile: EncodedTile) -> None:
        """A tile that has begun is finished. One that holds nothing does not count."""
        begun, weight = self._begun.pop(number), self._weights[number]
        if tile.seeds:
            self._overruns.append((time.monotonic() - begun.at - begun.assigned) / weight)
            self._decoding += tile.decoding
            self._decoded += weight

    def _ending(self) -> float:
        """Seconds from the last tile on: the stream is written and, if so, decoded and compared."""
        pixels = self._grid.width * self._grid.height
        if not self._decoders:
            return _WRITING + _WRITING_PIXEL * pixels
        decoding = _DECODING_PIXEL * pixels
        if self._decoded:
            whole = sum(self._weights.values()) * self._grid.count / len(self._weights)
            decoding = self._decoding / self._decoded * whole
        threads = min(self._decoders, _MAX_DECODERS)
        return _WRITING + (_WRITING_PIXEL + _COMPARING_PIXEL) * pixels + decoding / threads

    def _pixels(self, number: int) -> float:
        _, _, width, height = self._grid.rect(number)
        return float(width * height)


_RESERVED, _ALIKE = 0.5, 0.5
"""Part of an even share of the time that a tile leaves at least to each later turn of the workers; part of its weight
from which on other tiles count for a turn.
"""
_MIN_SECONDS, _MIN_PART = 1e-3, 0.5
"""What is assigned to a tile at least: seconds, and of its share. A fit of very few steps leaves so many seeds that
searching and coding them takes longer than more steps would have.
"""
_LAST = 5
"""Tiles whose overruns count; before the first is done, the median is 0."""
_WRITING, _WRITING_PIXEL = 0.5, 5e-9
_DECODING_PIXEL, _COMPARING_PIXEL = 3e-7, 1e-7
"""Seconds: of any stream, and for each pixel; a decode's by one thread, as long as no tile has been decoded."""
_MAX_DECODERS = 2
"""Threads that help a decode."""
