"""What is reported while an encode runs: listeners, and the state of a pass over tiles."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field

from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile.state import TileListener
from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.executors.executor import Memory
from sgicodec.model.tile_grid import Rect


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

    def add(self, tile: EncodedTile, core: Rect, fresh: bool) -> None:
        """Counts a tile."""
        pixels = core[2] * core[3]
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

    Of a picture in one tile, `stage` tells load, prepare, fit, search (of RDOQ), texture, residual and verify, of
    several tiles load, residual and verify alone. `step` and `ending` are asked of a picture in one tile; if they end
    it, the stream is made of the seeds as they are.
    """

    def planned(self, plan: Plan, workers: int, memory: Memory) -> None:
        """The encode begins: n tiles at a time, in this much memory."""

    def note(self, text: str) -> None:
        """Something about the picture that its owner should know."""

    def remark(self, text: str) -> None:
        """Something that was done to the picture and that loses nothing."""

    def tile(self, state: PassState) -> None:
        """A pass over the tiles begins, or one more of its tiles is done."""
