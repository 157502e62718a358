"""Tiles in rounds: fits of some, then of the others, then searches, until a goal for all of them together is met."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, partial
from typing import BinaryIO

from sgicodec.bitstream.stream_writer import stream_length, write_stream
from sgicodec.encoder.interfaces import Finished, Runner, Store, Task, Version, Watcher
from sgicodec.encoder.plan import Plan, fit_lmbda
from sgicodec.encoder.tile_work import EncodedTile, FitTask, LookaheadTask, SearchTask, Start
from sgicodec.encoder.time_budget import TimeBudget
from sgicodec.fit.settings import quality_index
from sgicodec.metrics.distortion import decibels
from sgicodec.rate_control.allocation import Option, choose
from sgicodec.rate_control.secant import FIT, SEARCH, Correction
from sgicodec.rate_control.target import LMBDA_RANGE, Measured, RateTarget
from sgicodec.rate_control.tile_rd_model import Bound, TileRdModel, spread

__all__ = ["TilePasses"]


class TilePasses:
    """Encodes the tiles of a plan. What a round does follows from what earlier ones came to alone, so that workers,
    order and interruptions do not matter.

    error_of: squared error of a stream over the whole picture, samples in 0..1. shares: who tells each fit its seconds,
    where time is the limit. draw_small: makes the overview of a stream whose tiles are fitted at this λ, if it is to
    have one.
    """

    def __init__(
        self,
        plan: Plan,
        runner: Runner,
        store: Store,
        watcher: Watcher,
        error_of: Callable[[BinaryIO], float],
        shares: TimeBudget | None = None,
        draw_small: Callable[[float], bytes] | None = None,
    ) -> None:
        self.plan, self.runner, self.store, self.watcher, self.error_of = plan, runner, store, watcher, error_of
        self.shares, self.draw_small = shares, draw_small
        self.overview: bytes | None = None
        header = plan.header
        self.all = range(header.grid.count)
        self.samples = header.width * header.height * header.spec.channels
        self.goal = plan.settings.rate_target(header.width * header.height)
        self.fade = 1.0
        """The picture's squared error over that of the tiles' cores."""

    def run(self) -> Finished:
        """All rounds. Raises TileFailedError; the store then has what was finished."""
        if self.goal is None:
            lmbda = fit_lmbda(self.plan.settings)
            self._make_overview(lmbda)
            self._round("tiles", 0, FitTask(self.plan), self.all, self._first)
            return Finished(self.plan, [Version(number) for number in self.all], lmbda, overview=self.overview)
        lmbda, index, samples, fits = self._lmbda(0, self.all, 0.0), 0, 1, 0
        self._make_overview(lmbda)
        while True:
            plan = self.plan.at(lmbda, quality_index(lmbda))
            base, index, wanted = self._fitted(plan, lmbda, index, samples < _SAMPLES)
            samples, fits = samples + 1, fits + (len(base) == len(self.all))
            if fits == _FITS or (fits and not _is_far(wanted, lmbda)):
                return self._settled(plan, base, index, self.goal)
            lmbda = wanted

    def _make_overview(self, lmbda: float) -> None:
        draw = self.draw_small
        if draw is None:
            return

        def made() -> bytes:
            self.watcher.begin("overview", [], {})
            return draw(lmbda)

        self.overview = self.store.cached("overview", made)

    def _fitted(self, plan: Plan, lmbda: float, index: int, may_stop: bool) -> tuple[dict[int, Version], int, float]:
        """Fits of all tiles, some first, which tell the λ of the others; stops where λ turns out to be far off.

        Returns the codings, the number of the next round, and the λ that all would want.
        """
        chosen: dict[int, Version] = {}
        at = wanted = lmbda
        while len(chosen) < len(self.all):
            numbers = self._stage(lmbda, chosen)
            self._round("sample" if not chosen else "tiles", index, FitTask(plan.at(at, plan.header.quality)), numbers)
            chosen |= {number: Version(number, index) for number in numbers}
            index += 1
            tiles = {number: self.store.tiles[version] for number, version in chosen.items()}
            bound = self._bound()
            self.outlook.learn(bound, tiles, lmbda)
            wanted = self._lmbda(2 * index - 1, self.all, 0.0)
            if may_stop and _is_far(wanted, lmbda):
                break
            rest = [number for number in self.all if number not in chosen]
            if rest:
                at = self._lmbda(2 * index, rest, sum(map(bound.of, tiles.values())))
                at = min(max(at, lmbda / 2**_FAR), lmbda * 2**_FAR)
        return chosen, index, wanted

    def _stage(self, lmbda: float, chosen: dict[int, Version]) -> list[int]:
        """The tiles to fit next."""
        rest = [number for number in self.all if number not in chosen]
        if not chosen:
            return spread(self.outlook.foretold(self.all, lmbda), min(_MOST_SAMPLES, max(2, len(rest) // 4)))
        return rest[::2] if len(chosen) <= _MOST_SAMPLES and len(self.all) >= _MANY else rest

    def _lmbda(self, number: int, tiles: Sequence[int], done: float) -> float:
        """λ that takes these tiles to the goal, kept under a number."""
        bound = self._bound()
        aimed = Bound(bound.what, _AIM[bound.what] * bound.value)
        return self.store.cached(f"lmbda {number}", lambda: self.outlook.lmbda(aimed, tiles, done))

    @cached_property
    def outlook(self) -> TileRdModel:
        """From a look at every tile."""
        self.watcher.begin("look", self.all, {})
        looks = {}
        for number, look in self.runner(LookaheadTask(self.plan), self.all, lambda _: Start()):
            looks[number] = look
            self.watcher.done(number, None)
        return TileRdModel([looks[number] for number in self.all], self._bound().what)

    def _bound(self, lengths: Iterable[int] | None = None) -> Bound:
        """What the goal leaves to the tiles; `lengths`: of their payloads, where they are known."""
        goal = self.goal or RateTarget()
        if goal.psnr is not None:
            return Bound("error", self.samples * 10 ** (-0.1 * goal.psnr) / self.fade)
        size = goal.bytes or 0.0
        lengths = [min(_LONG, round(size / len(self.all)))] * len(self.all) if lengths is None else list(lengths)
        return Bound("bytes", max(1.0, size - (self._length(self.plan, lengths) - sum(lengths))))

    def _settled(self, plan: Plan, base: dict[int, Version], index: int, goal: RateTarget) -> Finished:
        """Corrections of the fits until a choice of codings meets the goal."""
        versions = {number: [base[number]] for number in self.all}
        tried: list[tuple[float, float]] = []
        for count in range(_CORRECTIONS + 1):
            chosen, measured = self._choice(plan, versions, goal)
            bound = self._bound()
            fits = {number: bound.of(self.store.tiles[base[number]]) for number in self.all}
            need = bound.need(sum(fits.values()))
            kind = SEARCH if need > 0 else FIT
            if goal.is_met(measured) or count == _CORRECTIONS:
                break
            left = bound.need(sum(bound.of(self.store.tiles[version]) for version in chosen))
            fresh = [number for number in self.all if len(versions[number]) == 1]
            octaves, numbers = kind.next(left, fits, fresh, tried)
            if not self._corrected(kind, plan, base, octaves, numbers, index):
                break
            found = sum(bound.of(self.store.tiles[Version(number, index)]) for number in numbers)
            others = sum(fits.values()) / max(sum(fits[number] for number in numbers), 1e-9)
            tried.append((octaves, bound.need(found * others)))
            for number in numbers:
                versions[number].append(Version(number, index))
            index += 1
        missed = goal.miss_message(measured) if goal.is_missed(measured) else None
        return Finished(plan, chosen, self.store.tiles[base[self.all[-1]]].lmbda, missed, self.overview)

    def _corrected(
        self, kind: Correction, plan: Plan, base: dict[int, Version], octaves: float, numbers: list[int], index: int
    ) -> bool:
        """A round that moves the λ of some tiles by so many octaves, a part for each λ that there is among the fits;
        False where λ cannot move.
        """
        by_lmbda: dict[float, list[int]] = {}
        for number in numbers:
            by_lmbda.setdefault(self.store.tiles[base[number]].lmbda, []).append(number)
        for lmbda, some in by_lmbda.items():
            moved = lmbda * 2.0**octaves
            if moved < 0.999 * LMBDA_RANGE[0]:
                return False
            at = plan.at(moved, plan.header.quality)
            task: FitTask | SearchTask = SearchTask(at) if kind is SEARCH else FitTask(at)
            self._round(kind.name, index, task, some, partial(self._start, base))
        return bool(numbers)

    def _first(self, number: int) -> Start:
        return Start() if self.shares is None else Start(seconds=self.shares.begin(number))

    def _start(self, base: dict[int, Version], number: int) -> Start:
        version = base[number]
        return Start(self.store.payload(version), self.store.tiles[version].lmbda)

    def _choice(
        self, plan: Plan, versions: dict[int, list[Version]], goal: RateTarget
    ) -> tuple[list[Version], Measured]:
        """The best choice of codings, and what the stream is."""
        for _ in range(_MEASURES):
            chosen = self._best(versions)
            tiles = [self.store.tiles[version] for version in chosen]
            length = self._length(plan, [tile.length for tile in tiles])
            if goal.psnr is None:
                return chosen, Measured(length, math.inf)
            with tempfile.TemporaryFile() as file:
                write_stream(file, plan.header, plan.software, plan.metadata, map(self.store.payload, chosen))
                file.seek(0)
                error = self.error_of(file)
            self.fade = error / max(sum(tile.squared_error for tile in tiles), 1e-12) or 1.0
            measured = Measured(length, decibels(error, self.samples))
            if goal.is_met(measured) or all(len(some) == 1 for some in versions.values()):
                break
        return chosen, measured

    def _best(self, versions: dict[int, list[Version]]) -> list[Version]:
        def option(version: Version) -> Option:
            tile = self.store.tiles[version]
            size, error = float(tile.length), tile.squared_error
            return Option(size, error) if self._what == "bytes" else Option(error, size)

        options = [[option(version) for version in versions[number]] for number in self.all]
        lengths = [max(self.store.tiles[version].length for version in versions[number]) for number in self.all]
        chosen = choose(options, _ROOM[self._what] * self._bound(lengths).value)
        return [versions[number][index] for number, index in zip(self.all, chosen, strict=True)]

    @property
    def _what(self) -> str:
        return "bytes" if self.goal is not None and self.goal.psnr is None else "error"

    def _length(self, plan: Plan, lengths: Sequence[int]) -> int:
        return stream_length(plan.header, plan.software, plan.metadata, lengths, self.overview)

    def _round(
        self,
        name: str,
        index: int,
        task: Task[EncodedTile],
        numbers: Sequence[int],
        start: Callable[[int], Start] = lambda _: Start(),
    ) -> None:
        """Does what is not there yet."""
        there = {number: Version(number, index) for number in numbers if Version(number, index) in self.store.tiles}
        self.watcher.begin(name, numbers, {number: self.store.tiles[version] for number, version in there.items()})
        missing = [number for number in numbers if number not in there]
        if self.shares is not None:
            self.shares.expect(missing)
        if missing:
            for number, tile in self.runner(task, missing, start):
                if self.shares is not None:
                    self.shares.done(number, tile)
                self.store.add(Version(number, index), tile)
                self.watcher.done(number, tile)


_AIM = {"bytes": 0.985, "error": 0.995}
"""Where fits are to end, as a part of what all tiles together may have."""
_ROOM = {"bytes": 1.0, "error": 10**0.003}
"""What of the bound a choice may take: a PSNR may be 0.03 dB below, so that both sides of it have room."""
_LONG = 1 << 20
"""Bytes of a payload, where it is not known and there is room for any: what its frame takes hardly depends on it."""
_MOST_SAMPLES, _MANY = 8, 12
"""Tiles that are fitted first, and number of tiles from which on a half of the others comes before the rest."""
_FAR, _SAMPLES, _FITS = 0.5, 4, 2
"""Octaves that the λ of fits of one stream may be apart; how often samples, and how often all tiles are fitted."""
_CORRECTIONS, _MEASURES = 4, 2
"""Passes after the fits; measures of a PSNR in each."""


def _is_far(one: float, other: float) -> bool:
    return abs(math.log2(one / other)) > _FAR
