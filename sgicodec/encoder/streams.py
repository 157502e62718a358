"""Streams of one picture: of a plan, or the one that comes nearest to a size, a PSNR or a score."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.device import Device
from sgicodec.encoder.input.overview import overview_picture, overview_settings, takes_overview
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan, stream_plan
from sgicodec.encoder.progress import NullListener, PassState
from sgicodec.encoder.quality_calibration import with_quality_calibration
from sgicodec.encoder.residual.division import Division
from sgicodec.encoder.residual.layer import ResidualLayer, residual_payload
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tiles.runner import TileRunner
from sgicodec.encoder.tiles.store import Store, Version
from sgicodec.encoder.tiles.tasks import FitTask
from sgicodec.executors.executor import Executor
from sgicodec.metrics.distortion import decibels, squared_error
from sgicodec.metrics.visual_score import visual_score
from sgicodec.picture import Picture, to_rgb8
from sgicodec.profiles.default import lmbda_of_quality
from sgicodec.rate_control.quality_search import searched_quality
from sgicodec.rate_control.target import RateTarget

_SEED_QUALITIES = 4
"""Steps of quality between those at which seeds beneath texture are fitted on the way to a target. Half an octave of λ
beside that of texture costs nothing: two octaves cost 0.1 dB (docs/notes/2026-11-texture.md)."""


@dataclass(frozen=True)
class Request:
    """What is asked for of a picture. divided: what tiles show of it, and what a residual layer does."""

    windows: Windows
    plan: Plan
    divided: Callable[[Windows, Plan], Division]
    listener: NullListener
    device: Device
    check_unchanged: Callable[[], None] = lambda: None
    """Raises PictureError if the picture is no longer that of which tiles were made."""

    @property
    def target(self) -> RateTarget | None:
        """What the stream is to end at."""
        return self.plan.settings.rate_target(self.plan.header.width * self.plan.header.height)

    def tell(self, state: PassState) -> None:
        """Tells the listener, where there are several tiles: the only one reports its stages and steps itself."""
        if self.plan.header.grid.count > 1:
            self.listener.tile(state)

    def at_quality(self, quality: float, **changes: Any) -> Plan:
        """The plan at a quality, also one beyond those that have a name, without its target, of which the stream tells
        nevertheless. Seeds beneath texture are those of a round number: sizes follow the texture, which moves less by
        chance.
        """
        asked = self.plan.settings
        seeds = _SEED_QUALITIES * round(quality / _SEED_QUALITIES) if asked.texture else quality
        named: dict[str, float] = {"quality": seeds} if 1 <= seeds <= 100 else {"lmbda": lmbda_of_quality(seeds)}
        settings = asked.without_target(**named, tune=asked.tuned_for, **changes)
        plan = stream_plan(self.windows.shape, settings)
        return replace(plan, software=self.plan.software, texture_lmbda=lmbda_of_quality(quality))

    def psnr(self, stream: bytes | Path | BinaryIO) -> float:
        """PSNR in dB over all samples of what a stream decodes to, but for colours where alpha is 0. Raises StreamError
        if it does not decode.
        """
        with open_stream(stream, self.device.processor) as opened:
            return self._psnr(opened)

    def _psnr(self, stream: Stream) -> float:
        read, header = self.windows.read, self.plan.header
        error = sum(squared_error(read(0, top, band.width, band.height), band) for top, band in stream.bands())
        return decibels(error, header.width * header.height * header.spec.channels)

    def verified(self, stream: bytes | Path | BinaryIO) -> float:
        """The PSNR of a finished stream. The listener gets to know. Raises StreamError if it, or its overview, does not
        decode.
        """
        self.listener.stage("verify")
        with open_stream(stream, self.device.processor) as opened:
            if opened.has_overview:
                opened.overview.survey()
            psnr = self._psnr(opened)
        self.check_unchanged()
        return psnr

    def score(self, stream: BinaryIO) -> float:
        """SSIMULACRA 2 of a finished stream."""
        header = self.plan.header
        with open_stream(stream, self.device.processor) as opened:
            shown = to_rgb8(opened.picture())
        seen = to_rgb8(self.windows.read(0, 0, header.width, header.height))
        return visual_score(seen, shown, self.device.processor)


@dataclass(frozen=True)
class Finished:
    """A stream but for the payloads of its tiles. plan: that of its header; chosen: which coding of each tile it takes;
    overview: a stream of its own.
    """

    plan: Plan
    chosen: list[Version]
    overview: bytes | None
    residual: bytes | None = None

    def length(self, store: Store) -> int:
        """Bytes of its tiles, its overview and its residual layer."""
        others = sum(len(part) for part in (self.overview, self.residual) if part is not None)
        return sum(store.tiles[version].length for version in self.chosen) + others

    def write(self, file: BinaryIO, store: Store) -> int:
        """Writes the stream; returns its length."""
        plan, tiles = self.plan, map(store.payload, self.chosen)
        return write_stream(
            file, plan.stated(plan.header), plan.software, plan.metadata, tiles, self.overview, self.residual
        )


class Streams:
    """Streams of one picture, a pass over its tiles each. overview: what makes one by its settings, as a task."""

    def __init__(
        self,
        request: Request,
        executor: Executor,
        store: Store,
        overview: Callable[[EncodeSettings, int, Picture, Device], bytes],
    ) -> None:
        self._request, self._executor, self._store, self._make_overview = request, executor, store, overview
        self._passes = 0

    def of(self, plan: Plan, name: str = "tiles") -> Finished:
        """The stream of a plan, whatever its target. Raises TileFailedError; the store then has what was finished."""
        division = self._request.divided(self._request.windows, plan)
        finished = self._of_division(division, name)
        exact, size = division.exact, finished.length(self._store)
        if exact is None or not exact.may_be_taken(size):
            return finished
        without_loss = self._of_division(exact.division, name)
        return without_loss if without_loss.length(self._store) <= exact.worth * size else finished

    def _of_division(self, division: Division, name: str) -> Finished:
        """The stream of a picture that is divided: what its tiles lack of this pass is done. A pass follows from the
        results of earlier ones alone, so that workers, order and interruptions do not matter: one that goes on after
        an interruption has the same passes under the same numbers.
        """
        request, pass_number = self._request, self._passes
        self._passes += 1
        below, plan, layer = division.windows, division.plan, division.layer
        if request.target is None:  # which looks as it will: λ alone moves sizes by as little as is wanted
            plan = with_quality_calibration(below, plan)
        runner = TileRunner(below, plan, self._executor, request.device)
        grid, tiles = plan.header.grid, self._store.tiles
        overview = self._overview(plan, pass_number, runner) if takes_overview(plan) else None
        task = FitTask(plan) if plan.header.tile else FitTask(plan, request.listener)
        chosen = [Version(number, pass_number) for number in range(grid.count)]
        state = PassState(grid.count, plan.header.width * plan.header.height, name)
        for of in chosen:
            if of in tiles:
                state.add(tiles[of], grid.core(of.tile), fresh=False)
        request.tell(state)
        missing = [of.tile for of in chosen if of not in tiles]
        for number, tile in runner(task, missing) if missing else ():
            self._store.add(Version(number, pass_number), tile)
            state.add(tile, grid.core(number), fresh=True)
            request.tell(state)
        header = tiles[chosen[-1]].header
        finished = Finished(plan if header is None else replace(plan, header=header), chosen, overview)
        return finished if layer is None else replace(finished, residual=self._residual(finished, layer))

    def nearest(self, target: RateTarget) -> tuple[Finished, str | None]:
        """The stream that comes nearest to a target, and how it misses that, if it does."""
        request, settings, tried = self._request, self._request.plan.settings, dict[float, tuple[Finished, float]]()

        def measure(quality: float) -> float:
            finished = self.of(request.at_quality(quality))
            tried[quality] = finished, self._measured(finished, target)
            return tried[quality][1]

        def draft(quality: float) -> float:
            plan = request.at_quality(quality, effort=1, overview=False)
            return self._measured(self.of(plan, "drafts"), target)

        has_drafts = settings.steps is None and settings.effort > 1
        ending = request.listener.ending if not request.plan.header.tile else lambda: False
        finished, measured = tried[searched_quality(target, measure, draft if has_drafts else None, ending)]
        return finished, target.miss_message(measured) if target.is_missed(measured) else None

    def _measured(self, finished: Finished, target: RateTarget) -> float:
        """What a stream has of the quantity that the target is about."""
        with tempfile.TemporaryFile() as file:
            size = finished.write(file, self._store)
            if target.quantity == "bytes":
                return size
            file.seek(0)
            return self._request.psnr(file) if target.quantity == "psnr" else self._request.score(file)

    def _overview(self, plan: Plan, pass_number: int, runner: TileRunner) -> bytes:
        def made() -> bytes:
            self._request.tell(PassState(0, 0, "overview"))
            task = partial(self._make_overview, overview_settings(plan, plan.settings.fit_settings().lmbda))
            return dict(runner(task, [0], window=overview_picture(plan, self._request.windows.read)))[0]

        return self._store.cached(f"overview {pass_number}", made)

    def _residual(self, finished: Finished, layer: ResidualLayer) -> bytes:
        """The payload of the residual layer."""
        self._request.listener.stage("residual")
        with tempfile.TemporaryFile() as file:
            finished.write(file, self._store)
            file.seek(0)
            with open_stream(file, self._request.device.processor) as stream:
                return residual_payload(stream, layer, self._request.device)
