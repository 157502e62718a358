"""Passes over the tiles of a picture: fits of some, then of the others, then texture again until the target is met."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import BinaryIO, Literal

from sgicodec.bitstream.stream_writer import stream_length, write_stream
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.progress import PassReporter
from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.encoder.tiles.runner import TileRunner
from sgicodec.encoder.tiles.store import Store, Version
from sgicodec.encoder.tiles.tasks import FitTask, LookaheadTask, SearchTask, Task
from sgicodec.metrics.distortion import decibels
from sgicodec.model.steps import quality_index
from sgicodec.rate_control.step_search import OCTAVES_PER_UNIT, step_shift
from sgicodec.rate_control.target import LMBDA_MIN, Measured, RateTarget
from sgicodec.rate_control.tile_rd_model import TileRdModel, is_far, spread_over

__all__ = ["Finished", "TilePasses"]

MAX_SAMPLE_TILES, MAX_SAMPLES, MAX_FITS = 8, 3, 2
"""Tiles that are fitted first, how often, and how often all tiles are."""
AIM_BYTES, AIM_ERROR = 0.985, 0.995
"""Part of the bytes, or of the squared error, at which fits aim."""
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

    error_of: squared error of a stream over the whole picture, samples in 0..1. draw_small: makes the overview of a
    stream whose tiles are fitted at this λ, if it is to have one.
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
        self.passes = 0

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
        """Fits whose λ follows from the sizes of those before, then passes that search texture again, at a λ that moves
        until all tiles together meet the target.
        """
        lmbda = self._lmbda(target)
        self._make_overview(lmbda)
        for _ in range(MAX_FITS):
            plan, fits, lmbda = self._fitted(target, lmbda)
            wanted = self._learned(target, fits, lmbda)
            if not is_far(wanted, lmbda):
                break
            lmbda = wanted
        tried = {0.0: (fits, self._measured(target, plan, fits))}

        def measure(shift: float) -> Measured:
            if shift not in tried:
                chosen = self._searched(plan, fits, 2.0 ** (-OCTAVES_PER_UNIT * shift))
                tried[shift] = chosen, self._measured(target, plan, chosen)
            return tried[shift][1]

        chosen, measured = tried[step_shift(target, measure)]
        missed = target.miss_message(measured) if target.is_missed(measured) else None
        return Finished(plan, chosen, self.store.tiles[fits[-1]].lmbda, missed, self.overview)

    def _make_overview(self, lmbda: float) -> None:
        draw = self.draw_small
        if draw is None:
            return

        def made() -> bytes:
            self.reporter.begin("overview", [], {})
            return draw(lmbda)

        self.overview = self.store.cached("overview", made)

    def _fitted(self, target: RateTarget, lmbda: float) -> tuple[Plan, list[Version], float]:
        """Fits of some tiles, again where they show λ to be far off, then of the others at the λ that follows, which is
        returned, too.
        """
        some = spread_over(self.rd_model.predict(lmbda), min(MAX_SAMPLE_TILES, max(2, len(self.all) // 4)))
        for _ in range(MAX_SAMPLES):
            plan, sample = self.plan.at(lmbda, quality_index(lmbda)), self._new_pass()
            self._pass("sample", sample, self._fit_at(plan), some)
            wanted, at = self._learned(target, [Version(number, sample) for number in some], lmbda), lmbda
            if not is_far(wanted, lmbda):
                at = wanted
                break
            lmbda = wanted
        rest, others = [number for number in self.all if number not in some], self._new_pass()
        if rest:
            self._pass("tiles", others, self._fit_at(plan.at(at, plan.header.quality)), rest)
        return plan, [Version(number, sample if number in some else others) for number in self.all], at

    def _fit_at(self, plan: Plan) -> FitTask:
        """What fits tiles at the plan's λ, and measures what the R-D model learns from."""
        return FitTask(plan, measures=self.target is not None and self.target.bytes is None)

    def _learned(self, target: RateTarget, chosen: list[Version], lmbda: float) -> float:
        """The λ that the target wants, by what these tiles have at this one."""
        tiles = [self.store.tiles[version] for version in chosen]
        found = sum(tile.squared_error if target.bytes is None else tile.length for tile in tiles)
        self.rd_model.learn([version.tile for version in chosen], lmbda, found)
        return self._lmbda(target)

    def _searched(self, plan: Plan, fits: list[Version], factor: float) -> list[Version]:
        """All tiles with texture for `factor` times the λ of their fits."""
        index = self._new_pass()
        by_lmbda: dict[float, list[int]] = {}
        for version in fits:
            by_lmbda.setdefault(self.store.tiles[version].lmbda, []).append(version.tile)
        for lmbda, numbers in by_lmbda.items():
            task = SearchTask(plan.at(max(factor * lmbda, LMBDA_MIN), plan.header.quality))
            self._pass("search", index, task, numbers, lambda number: self.store.payload(fits[number]))
        return [Version(number, index) for number in self.all]

    def _lmbda(self, target: RateTarget) -> float:
        """λ that takes all tiles to the target, kept for each pass."""

        def found() -> float:
            if target.bytes is None:
                return self.rd_model.lmbda(AIM_ERROR * self.samples * 10 ** (-0.1 * (target.psnr or 0.0)))
            lengths = [min(UNKNOWN_PAYLOAD_BYTES, round(target.bytes / len(self.all)))] * len(self.all)
            side_bytes = self._length(self.plan, lengths) - sum(lengths)
            return self.rd_model.lmbda(AIM_BYTES * max(1.0, target.bytes - side_bytes))

        return self.store.cached(f"lmbda {self.passes}", found)

    @cached_property
    def rd_model(self) -> TileRdModel:
        """From a lookahead at every tile."""
        self.reporter.begin("lookahead", self.all, {})
        tables = {}
        for number, table in self.runner(LookaheadTask(self.plan), self.all):
            tables[number] = table
            self.reporter.done(number, None)
        what: Literal["bytes", "error"] = "error" if self.target and self.target.bytes is None else "bytes"
        return TileRdModel([tables[number] for number in self.all], what)

    def _measured(self, target: RateTarget, plan: Plan, chosen: list[Version]) -> Measured:
        """What the stream of these codings is."""
        length = self._length(plan, [self.store.tiles[version].length for version in chosen])
        if target.bytes is not None:
            return Measured(length, math.inf)
        with tempfile.TemporaryFile() as file:
            write_stream(file, plan.header, plan.software, plan.metadata, map(self.store.payload, chosen))
            file.seek(0)
            return Measured(length, decibels(self.error_of(file), self.samples))

    def _length(self, plan: Plan, lengths: Sequence[int]) -> int:
        return stream_length(plan.header, plan.software, plan.metadata, lengths, self.overview)

    def _new_pass(self) -> int:
        """The number of the pass that comes."""
        self.passes += 1
        return self.passes - 1

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
