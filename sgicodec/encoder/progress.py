"""What is reported while an encode runs: listeners, the state of a pass over tiles, and which share of all is done."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile.state import TileListener
from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.executors.executor import Memory
from sgicodec.metrics.distortion import decibels

__all__ = ["NullListener", "PassReporter", "PassState", "StageClock", "stage_weights"]


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
    squared_error: float = 0.0
    samples: int = 0
    started: float = field(default_factory=time.monotonic)

    def add(self, tile: EncodedTile | None, pixels: int, fresh: bool) -> None:
        """Counts a tile whose core has n pixels; None if it was only analysed."""
        self.done += 1
        self.pixels += pixels
        self.fresh += pixels if fresh else 0
        if tile is None:
            return
        self.bytes += tile.length
        self.squared_error += tile.squared_error
        self.samples += tile.samples

    @property
    def psnr(self) -> float:
        """dB over the tiles so far."""
        return decibels(self.squared_error, self.samples)

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

    def done(self, number: int, tile: EncodedTile | None) -> None:
        """One more is done; None if it was only analysed."""
        self._state.add(tile, self._area(number), fresh=True)
        self._tell()

    def _tell(self) -> None:
        if self._grid.count > 1:
            self._listener.tile(self._state)

    def _area(self, number: int) -> int:
        _, _, width, height = self._grid.core(number)
        return width * height


_PREPARE, _FIT, _SEARCH, _TEXTURE, _ASCENT, _ROUND, _VERIFY = 0.5, 5e-3, 1e-3, 0.4, 0.2, 0.6, 0.1
"""Seconds of each stage, of the fit and the search for each step, of texture for each pass of ascent or round of
requantisation besides, relative to the others: of a photograph of 0.4 megapixels. Machines and pictures differ in the
sum far more than in the shares.
"""

_MAX_ESTIMATED = 0.97
"""How much of a stage that does not say how far it is counts as done, however long it takes."""


def stage_weights(plan: Plan) -> dict[str, float]:
    """What share of the time each stage takes, relative to the others, in their order."""
    settings = plan.settings
    if plan.header.tile:
        again = {"more passes": 0.7} if settings.target else {}
        return {"load": 0.02, "tiles": 1.0, **again, "verify": 0.1}
    effort = settings.chosen_effort
    search = {"search": 0.45 + _SEARCH * effort.steps} if settings.rdoq and plan.header.spec.context.prior else {}
    seconds = _TEXTURE + _ASCENT * effort.ascent_passes + _ROUND * effort.rounds
    texture = {"texture": seconds} if plan.header.spec.texture else {}
    return {
        "load": 0.05,
        "prepare": _PREPARE,
        "fit": 0.1 + _FIT * effort.steps,
        **search,
        **texture,
        "verify": _VERIFY,
    }


class StageClock:
    """Which share of an encode is done, from 0 to 1, never less than before.

    A stage that says how far it is counts by that, another one by its time, at the pace of those before. One that
    begins again, as towards a target, shares with those behind it what is left.
    """

    def __init__(self) -> None:
        self.name = "load"
        self._weights: Mapping[str, float] = {"load": 1.0}
        self._first, self._base, self._done = "load", 0.0, 0.0
        self._share: float | None = None
        self._started = self._entered = self._restarted = time.monotonic()

    def plan(self, weights: Mapping[str, float]) -> None:
        """States the stages in their order."""
        self._weights = weights

    def begin(self, name: str) -> None:
        """A stage begins; one that is not planned belongs to the one before."""
        names = list(self._weights)
        if name not in names:
            return
        if self.name in names and names.index(name) <= names.index(self.name) and name != "load":
            self._base, self._first = self.fraction, name
            self._restarted = time.monotonic()
        self.name, self._share, self._entered = name, None, time.monotonic()

    def advance(self, share: float) -> None:
        """The stage says which share of it is done."""
        self._share = share

    def finish(self) -> None:
        """All is done."""
        self._done = 1.0

    @property
    def fraction(self) -> float:
        """Which share of the whole is done."""
        before, own, behind = self._sums()
        inner = self._share if self._share is not None else self._estimated(before, own)
        share = self._base + (1 - self._base) * (before + own * inner) / (before + own + behind)
        self._done = max(self._done, min(share, 1.0))
        return self._done

    @property
    def seconds_left(self) -> float | None:
        """Until all is done, at the pace so far; None before that can be said."""
        done = self.fraction
        return None if done < 0.03 else (time.monotonic() - self._started) * (1 - done) / done

    def _sums(self) -> tuple[float, float, float]:
        """The weights before the stage, since the last one that began again, its own and of those behind it."""
        names = list(self._weights)
        first, here = (names.index(name) if name in names else 0 for name in (self._first, self.name))
        weights = list(self._weights.values())
        return sum(weights[first:here]), weights[here], sum(weights[here + 1 :])

    def _estimated(self, before: float, own: float) -> float:
        spent = self._entered - self._restarted
        pace = spent / before if before > 0 and spent > 0 else 1.0
        return min(_MAX_ESTIMATED, (time.monotonic() - self._entered) / (pace * own))
