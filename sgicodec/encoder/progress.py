"""What is reported while an encode runs: listeners, and the state of a pass over tiles."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field

from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile.state import TileListener
from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.executors.executor import Memory

__all__ = ["NullListener", "PassReporter", "PassState"]


@dataclass
class PassState:
    """How far a pass over several tiles has come. pixels: of the cores that are done; fresh of them in this run.
    name: what is done to the tiles.
    """

    tiles: int
    all_pixels: int
    name: str = "tiles"
    done: int = 0
    pixels: int = 0
    fresh: int = 0
    bytes: int = 0
    started: float = field(default_factory=time.monotonic)

    def add(self, tile: EncodedTile, pixels: int, fresh: bool) -> None:
        """Counts a tile whose core has n pixels."""
        self.done += 1
        self.pixels += pixels
        self.fresh += pixels if fresh else 0
        self.bytes += tile.length

    @property
    def bpp(self) -> float:
        """Bits per pixel of the tiles so far."""
        return 8 * self.bytes / max(1, self.pixels)

    @property
    def pixels_per_second(self) -> float:
        """Of this run."""
        return self.fresh / max(1e-9, time.monotonic() - self.started)

    @property
    def seconds_left(self) -> float:
        """Until the last tile is done, at the speed so far; infinite before the first."""
        return (self.all_pixels - self.pixels) / self.pixels_per_second if self.fresh else math.inf


class NullListener(TileListener):
    """A listener that ignores all reports. Others override what they want to know.

    Of a picture in one tile, `stage` tells load, prepare, fit, search, texture and verify, of several tiles load and
    verify alone. `step` and `ending` are asked of a picture in one tile; if they end it, the stream is made of the
    seeds as they are.
    """

    def planned(self, plan: Plan, workers: int, memory: Memory) -> None:
        """The encode begins: n tiles at a time, in this much memory."""

    def note(self, text: str) -> None:
        """Something about the picture that its owner should know."""

    def remark(self, text: str) -> None:
        """Something that was done to the picture and that loses nothing."""

    def tile(self, state: PassState) -> None:
        """A pass over the tiles begins, or one more of its tiles is done."""


class PassReporter:
    """Reports the state of each pass to a listener, where there are several tiles: the only one reports its stages and
    steps itself.
    """

    def __init__(self, plan: Plan, listener: NullListener) -> None:
        self._grid, self._listener = plan.header.grid, listener
        self._state = PassState(0, 0)

    def begin(self, name: str, numbers: Sequence[int], there: dict[int, EncodedTile]) -> None:
        """A pass over these tiles begins, some of which are there already."""
        self._state = PassState(len(numbers), sum(map(self._area, numbers)), name)
        for number, tile in there.items():
            self._state.add(tile, self._area(number), fresh=False)
        self._tell()

    def done(self, number: int, tile: EncodedTile) -> None:
        """One more is done."""
        self._state.add(tile, self._area(number), fresh=True)
        self._tell()

    def _tell(self) -> None:
        if self._grid.count > 1:
            self._listener.tile(self._state)

    def _area(self, number: int) -> int:
        _, _, width, height = self._grid.core(number)
        return width * height
