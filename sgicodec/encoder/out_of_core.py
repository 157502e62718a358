"""From an opened picture to a stream, tile by tile: no more than some windows of it is ever in memory."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, TypeVar

from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ALL_CORES, ONE_THREAD, Device
from sgicodec.encoder.checkpoint import Journal
from sgicodec.encoder.interfaces import Finished, Runner, Task
from sgicodec.encoder.measure import measured_error
from sgicodec.encoder.passes import TilePasses
from sgicodec.encoder.pipeline import draw_small
from sgicodec.encoder.plan import Plan, Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile_encoder import make_ready
from sgicodec.encoder.tile_weight import tile_weight
from sgicodec.encoder.tile_work import EncodedTile, Start
from sgicodec.encoder.time_budget import TimeShares
from sgicodec.encoder.worker import Job, ReadingTask, TileTask
from sgicodec.executors.processes import run_here, run_in_processes
from sgicodec.image import Source
from sgicodec.image.files import whole_file
from sgicodec.metrics.distortion import decibels
from sgicodec.picture import Picture

if TYPE_CHECKING:
    from sgicodec.executors.dask import Cluster

__all__ = ["State", "Totals", "encode_source", "plan_of", "run_on_cluster", "run_tiles", "time_shares"]

Result = TypeVar("Result")


@dataclass
class State:
    """How far a round over several tiles has come. pixels: of the cores that are done; fresh of them in this run.
    round: what is done to them.
    """

    tiles: int
    all_pixels: int
    round: str = "tiles"
    done: int = 0
    pixels: int = 0
    fresh: int = 0
    bytes: int = 0
    squared_error: float = 0.0
    samples: int = 0
    started: float = field(default_factory=time.monotonic)

    def add(self, tile: EncodedTile | None, pixels: int, fresh: bool) -> None:
        """Counts a tile whose core has so many pixels; None if it was only looked at."""
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
        """Until the last tile is done, at the pace so far; infinite before the first."""
        return (self.all_pixels - self.pixels) / self.pixels_per_second if self.fresh else math.inf


@dataclass(frozen=True)
class Totals:
    """Figures of a finished stream, as in `Encoded`. steps: of a fit, the mean over the tiles that have any.
    missed: what was asked for and not reached.
    """

    bytes: int
    part_bytes: dict[str, float]
    seeds: int
    gaussians: int
    lmbda: float
    steps: int
    missed: str | None = None


def plan_of(source: Source, settings: EncodeSettings) -> Plan:
    """The plan of an opened picture. The samples of floats are read once, for their range."""
    header = source.header
    shape = (source.width, source.height, source.channels, header.count, source.dtype)
    return stream_plan(Shape(*shape, source.sample_range, source.metadata, source.nodata), settings)


def run_on_cluster(
    source: Source, plan: Plan, cluster: Cluster, place: str | None, device: Device = ONE_THREAD
) -> Runner:
    """Tiles on a cluster, whose workers read the picture at `place`, or are sent their pixels if it is None. What
    computes in each is `device`.
    """

    def runner(
        task: Task[Result], numbers: Sequence[int], start: Callable[[int], Start], window: Picture | None = None
    ) -> Iterator[tuple[int, Result]]:
        ready = None if plan.settings.time_limit is None else make_ready
        if place is None or window is not None:
            return cluster.run(TileTask(task, device), numbers, _jobs(source, plan, start, window), ready)
        work = ReadingTask(plan, place, task, device)
        return cluster.run(work, numbers, lambda number: Job(None, start(number)), ready)

    return runner


def run_tiles(source: Source, plan: Plan, workers: int, device: Device) -> Runner:
    """Tiles in this process, or in several that are sent their pixels; `device`'s threads are shared among them."""

    def runner(
        task: Task[Result], numbers: Sequence[int], start: Callable[[int], Start], window: Picture | None = None
    ) -> Iterator[tuple[int, Result]]:
        count, jobs = min(workers, len(numbers)), _jobs(source, plan, start, window)
        work = TileTask(task, device.with_threads(max(1, device.cores // max(1, count))))
        if workers == 1:
            make_ready()
            return run_here(work, numbers, jobs)
        return run_in_processes(work, numbers, jobs, count, make_ready)

    return runner


def _jobs(source: Source, plan: Plan, start: Callable[[int], Start], window: Picture | None) -> Callable[[int], Job]:
    return lambda number: Job(window or _window(source, plan, number), start(number))


def _window(source: Source, plan: Plan, number: int) -> Picture:
    """Reads what a tile covers, with no more metadata than a fit needs."""
    return replace(source.read(*plan.header.grid.rect(number)), metadata=plan.place_of_windows)


def time_shares(source: Source, plan: Plan, end: float, workers: int, decoders: int) -> TimeShares:
    """Who tells each tile of an opened picture its part of the time until `end`; the rest as in `TimeShares`."""

    def weigh(number: int) -> float:
        return tile_weight(_window(source, plan, number), plan)

    return TimeShares(plan.header.grid, end, workers, decoders, weigh)


class _Telling:
    """Keeps the state of the round under way and tells of it."""

    def __init__(self, plan: Plan, on_state: Callable[[State], None] | None) -> None:
        self._grid, self._on_state = plan.header.grid, on_state or (lambda _: None)
        self._state = State(0, 0)

    def begin(self, name: str, numbers: Sequence[int], there: dict[int, EncodedTile]) -> None:
        """As in `Watcher`."""
        self._state = State(len(numbers), sum(map(self._area, numbers)), name)
        for number, tile in there.items():
            self._state.add(tile, self._area(number), fresh=False)
        self._on_state(self._state)

    def done(self, number: int, tile: EncodedTile | None) -> None:
        """As in `Watcher`."""
        self._state.add(tile, self._area(number), fresh=True)
        self._on_state(self._state)

    def _area(self, number: int) -> int:
        _, _, width, height = self._grid.core(number)
        return width * height


def encode_source(
    source: Source,
    plan: Plan,
    runner: Runner,
    journal: Journal,
    target: Path | BinaryIO,
    on_state: Callable[[State], None] | None = None,
    shares: TimeShares | None = None,
    device: Device = ALL_CORES,
) -> Totals:
    """Does what the journal lacks and writes the stream, the same whoever did it in whatever order unless `shares` tell
    each fit its time.

    Raises TileFailedError; the journal then has what was finished.
    """

    def error_of(file: BinaryIO) -> float:
        with open_stream(file, device) as stream:
            return measured_error(stream, source)

    small = draw_small(plan, source.read, runner)
    found = TilePasses(plan, runner, journal, _Telling(plan, on_state), error_of, shares, small).run()
    if isinstance(target, Path):
        with whole_file(target) as file:
            size = _write(file, found, journal)
    else:
        size = _write(target, found, journal)
    tiles = [journal.tiles[version] for version in found.chosen]
    parts: Counter[str] = Counter()
    for tile in tiles:
        parts.update(tile.part_bytes)
    if found.overview:
        parts["overview"] = len(found.overview)
    seeds = sum(tile.seeds for tile in tiles)
    gaussians = seeds * plan.header.spec.per_seed
    steps = [tile.steps for tile in tiles if tile.steps]
    mean = round(sum(steps) / max(1, len(steps)))
    return Totals(size, dict(parts), seeds, gaussians, found.lmbda, mean, found.missed)


def _write(file: BinaryIO, found: Finished, journal: Journal) -> int:
    plan = found.plan
    tiles = map(journal.payload, found.chosen)
    return write_stream(file, plan.header, plan.software, plan.metadata, tiles, found.overview)
