"""Passes over the tiles of a picture: fits of some, then of the others, then corrections, until the target is met."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import BinaryIO

from sgicodec.bitstream.stream_writer import stream_length, write_stream
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.progress import PassReporter
from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.encoder.tiles.runner import TileRunner
from sgicodec.encoder.tiles.store import Store, Version
from sgicodec.encoder.tiles.tasks import FitTask, LookaheadTask, SearchTask, Task
from sgicodec.metrics.distortion import decibels
from sgicodec.model.steps import quality_index
from sgicodec.rate_control.allocation import allocate
from sgicodec.rate_control.target import LMBDA_MIN, Measured, RateTarget
from sgicodec.rate_control.tile_passes import MAX_FITS, MAX_SAMPLES, is_far, kept_near, next_correction, tiles_of_pass
from sgicodec.rate_control.tile_rd_model import Bound, TileRdModel

__all__ = ["Finished", "TilePasses"]

MAX_CORRECTIONS, MAX_MEASURES = 4, 2
"""Passes after the fits; measurements of a PSNR in each."""
UNKNOWN_PAYLOAD_BYTES = 1 << 20
"""Of a payload that is not known yet, where there is room for any: what its frame takes hardly depends on it."""


@dataclass(frozen=True)
class Finished:
    """Which coding of each tile the stream takes, the plan of its header, the λ of the last fits, and what was asked
    for and not reached. overview: a stream of its own.
    """

    plan: Plan
    chosen: list[Version]
    lmbda: float
    missed: str | None = None
    overview: bytes | None = None


class TilePasses:
    """Encodes the tiles of a plan, each at first by `task`. A pass follows from the results of earlier passes alone, so
    that workers, order and interruptions do not matter.

    error_of: squared error of a stream over the whole picture, samples in 0..1. draw_small:
    makes the overview of a stream whose tiles are fitted at this λ, if it is to have one.
    """

    def __init__(
        self,
        task: FitTask,
        runner: TileRunner,
        store: Store,
        reporter: PassReporter,
        error_of: Callable[[BinaryIO], float],
        draw_small: Callable[[float], bytes] | None = None,
    ) -> None:
        plan = task.plan
        self.task, self.plan, self.runner, self.store = task, plan, runner, store
        self.reporter, self.error_of, self.draw_small = reporter, error_of, draw_small
        self.overview: bytes | None = None
        header = plan.header
        self.all = range(header.grid.count)
        self.samples = header.width * header.height * header.spec.channels
        self.target = plan.settings.rate_target(header.width * header.height) if header.tile else None
        """What the tiles go to together; the only one goes to it by itself."""
        self.error_ratio = 1.0
        """The picture's squared error over that of the tiles' cores: cross-fades make it smaller."""

    def run(self) -> Finished:
        """All passes. Raises TileFailedError; the store then has what was finished."""
        return self._at_lmbda() if self.target is None else self._at_target(self.target)

    def _at_lmbda(self) -> Finished:
        """One pass at the λ of the plan."""
        self._make_overview(self.plan.settings.fit_settings().lmbda)
        self._pass("tiles", 0, self.task, self.all)
        last = self.store.tiles[Version(self.all[-1])]
        plan = self.plan if last.header is None else replace(self.plan, header=last.header)
        return Finished(plan, [Version(number) for number in self.all], last.lmbda, last.missed, self.overview)

    def _at_target(self, target: RateTarget) -> Finished:
        """Fits whose λ follows from the sizes of those before, then corrections."""
        lmbda, index, samples, fits = self._lmbda(target, 0, self.all, 0.0), 0, 1, 0
        self._make_overview(lmbda)
        while True:
            plan = self.plan.at(lmbda, quality_index(lmbda))
            base, index, wanted = self._fitted(target, plan, lmbda, index, samples < MAX_SAMPLES)
            samples, fits = samples + 1, fits + (len(base) == len(self.all))
            if fits == MAX_FITS or (fits and not is_far(wanted, lmbda)):
                return self._corrected(target, plan, base, index)
            lmbda = wanted

    def _make_overview(self, lmbda: float) -> None:
        draw = self.draw_small
        if draw is None:
            return

        def made() -> bytes:
            self.reporter.begin("overview", [], {})
            return draw(lmbda)

        self.overview = self.store.cached("overview", made)

    def _fitted(
        self, target: RateTarget, plan: Plan, lmbda: float, index: int, may_stop: bool
    ) -> tuple[dict[int, Version], int, float]:
        """Fits of all tiles, some first, whose results move the λ of the others; stops where λ turns out to be far off.

        Returns the codings, the number of the next pass, and the λ that all tiles would want.
        """
        chosen: dict[int, Version] = {}
        at = wanted = lmbda
        while len(chosen) < len(self.all):
            numbers = tiles_of_pass(self.rd_model.predict(self.all, lmbda), chosen)
            self._pass("sample" if not chosen else "tiles", index, FitTask(plan.at(at, plan.header.quality)), numbers)
            chosen |= {number: Version(number, index) for number in numbers}
            index += 1
            tiles = {number: self.store.tiles[version] for number, version in chosen.items()}
            bound = self._bound(target)
            self.rd_model.learn(bound, tiles, lmbda)
            wanted = self._lmbda(target, 2 * index - 1, self.all, 0.0)
            if may_stop and is_far(wanted, lmbda):
                break
            rest = [number for number in self.all if number not in chosen]
            if rest:
                at = kept_near(self._lmbda(target, 2 * index, rest, sum(map(bound.of, tiles.values()))), lmbda)
        return chosen, index, wanted

    def _lmbda(self, target: RateTarget, number: int, tiles: Sequence[int], done: float) -> float:
        """λ that takes these tiles to the target, kept under a number."""
        aim = self._bound(target).aim
        return self.store.cached(f"lmbda {number}", lambda: self.rd_model.lmbda(aim, tiles, done))

    @cached_property
    def rd_model(self) -> TileRdModel:
        """From a lookahead at every tile."""
        self.reporter.begin("lookahead", self.all, {})
        tables = {}
        for number, table in self.runner(LookaheadTask(self.plan), self.all):
            tables[number] = table
            self.reporter.done(number, None)
        what = "bytes" if self.target is None else self._bound(self.target).what
        return TileRdModel([tables[number] for number in self.all], what)

    def _bound(self, target: RateTarget, lengths: Sequence[int] | None = None) -> Bound:
        """What the target leaves to the tiles; `lengths`: of their payloads, where they are known."""
        side_bytes = 0
        if target.bytes is not None:
            if lengths is None:
                lengths = [min(UNKNOWN_PAYLOAD_BYTES, round(target.bytes / len(self.all)))] * len(self.all)
            side_bytes = self._length(self.plan, lengths) - sum(lengths)
        return Bound.of_target(target, side_bytes, self.samples, self.error_ratio)

    def _corrected(self, target: RateTarget, plan: Plan, base: dict[int, Version], index: int) -> Finished:
        """Corrections of the fits until an allocation of codings meets the target."""
        versions = {number: [base[number]] for number in self.all}
        tried: list[tuple[float, float]] = []
        moved: dict[int, tuple[float, float]] = {}  # by how many octaves a tile was corrected last, and what it took
        for count in range(MAX_CORRECTIONS + 1):
            chosen, measured = self._allocation(target, plan, versions)
            if target.is_met(measured) or count == MAX_CORRECTIONS:
                break
            bound = self._bound(target)
            fits = {number: bound.of(self.store.tiles[base[number]]) for number in self.all}
            coarser = bound.error(sum(fits.values())) > 0
            left = bound.error(sum(bound.of(self.store.tiles[version]) for version in chosen))
            fresh = [number for number in self.all if len(versions[number]) == 1]
            octaves, numbers = next_correction(coarser, left, fits, fresh, tried)
            if not self._correct(plan, base, octaves, numbers, index):
                break
            results = {number: bound.of(self.store.tiles[Version(number, index)]) for number in numbers}
            moved |= {number: (octaves, taken) for number, taken in results.items()}
            change = sum(results.values()) / max(sum(fits[number] for number in numbers), 1e-9)
            like = {number: taken for number, (by, taken) in moved.items() if by == octaves}
            all_ = sum(like.get(number, change * fits[number]) for number in self.all)
            tried.append((octaves, bound.error(all_)))
            for number in numbers:
                versions[number].append(Version(number, index))
            index += 1
        missed = target.miss_message(measured) if target.is_missed(measured) else None
        return Finished(plan, chosen, self.store.tiles[base[self.all[-1]]].lmbda, missed, self.overview)

    def _correct(self, plan: Plan, base: dict[int, Version], octaves: float, numbers: list[int], index: int) -> bool:
        """A pass that moves the λ of some tiles by `octaves`, one part for each λ of the fits; False where λ
        cannot move.
        """
        by_lmbda: dict[float, list[int]] = {}
        for number in numbers:
            by_lmbda.setdefault(self.store.tiles[base[number]].lmbda, []).append(number)
        for lmbda, some in by_lmbda.items():
            moved = lmbda * 2.0**octaves
            if moved < 0.999 * LMBDA_MIN:
                return False
            task = SearchTask(plan.at(moved, plan.header.quality))
            self._pass("search", index, task, some, lambda number: self.store.payload(base[number]))
        return bool(numbers)

    def _allocation(
        self, target: RateTarget, plan: Plan, versions: dict[int, list[Version]]
    ) -> tuple[list[Version], Measured]:
        """The best allocation of codings, and what its stream is."""
        for _ in range(MAX_MEASURES):
            chosen = self._allocated(target, versions)
            tiles = [self.store.tiles[version] for version in chosen]
            length = self._length(plan, [tile.length for tile in tiles])
            if self._bound(target).what == "bytes":
                return chosen, Measured(length, math.inf)
            with tempfile.TemporaryFile() as file:
                write_stream(file, plan.header, plan.software, plan.metadata, map(self.store.payload, chosen))
                file.seek(0)
                error = self.error_of(file)
            self.error_ratio = error / max(sum(tile.squared_error for tile in tiles), 1e-12) or 1.0
            measured = Measured(length, decibels(error, self.samples))
            if target.is_met(measured) or all(len(some) == 1 for some in versions.values()):
                break
        return chosen, measured

    def _allocated(self, target: RateTarget, versions: dict[int, list[Version]]) -> list[Version]:
        lengths = [max(self.store.tiles[version].length for version in versions[number]) for number in self.all]
        bound = self._bound(target, lengths)
        options = [[bound.option(self.store.tiles[version]) for version in versions[number]] for number in self.all]
        chosen = allocate(options, bound.limit)
        return [versions[number][index] for number, index in zip(self.all, chosen, strict=True)]

    def _length(self, plan: Plan, lengths: Sequence[int]) -> int:
        return stream_length(plan.header, plan.software, plan.metadata, lengths, self.overview)

    def _pass(
        self,
        name: str,
        index: int,
        task: Task[EncodedTile],
        numbers: Sequence[int],
        start: Callable[[int], bytes] = lambda _: b"",
    ) -> None:
        """Does what is not there yet."""
        there = {number: Version(number, index) for number in numbers if Version(number, index) in self.store.tiles}
        self.reporter.begin(name, numbers, {number: self.store.tiles[version] for number, version in there.items()})
        missing = [number for number in numbers if number not in there]
        if missing:
            for number, tile in self.runner(task, missing, start):
                self.store.add(Version(number, index), tile)
                self.reporter.done(number, tile)
