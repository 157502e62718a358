"""From an opened picture to a stream, tile by tile: no more than some windows of it is ever in memory."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from sgicodec.assembly import write_stream
from sgicodec.encode_settings import EncodeSettings
from sgicodec.encoder import EncodedTile
from sgicodec.files import whole_file
from sgicodec.image import Picture, Source
from sgicodec.large.journal import Journal
from sgicodec.large.pool import run_here, run_in_processes
from sgicodec.large.task import ReadingTask, TileTask
from sgicodec.plan import Plan, Shape, fit_lmbda, stream_plan

if TYPE_CHECKING:
    from sgicodec.large.cluster import Cluster

__all__ = ["State", "Totals", "encode_source", "plan_of", "run_on_cluster", "run_tiles"]

Runner = Callable[[Iterable[int]], Iterator[tuple[int, EncodedTile]]]


@dataclass
class State:
    """How far an encode of several tiles has come. pixels: of the cores that are done; fresh of them in this run."""

    tiles: int
    all_pixels: int
    done: int = 0
    pixels: int = 0
    fresh: int = 0
    bytes: int = 0
    squared_error: float = 0.0
    samples: int = 0
    started: float = field(default_factory=time.monotonic)

    def add(self, tile: EncodedTile, pixels: int, fresh: bool) -> None:
        """Counts a tile whose core has so many pixels."""
        self.done += 1
        self.pixels += pixels
        self.fresh += pixels if fresh else 0
        self.bytes += tile.length
        self.squared_error += tile.squared_error
        self.samples += tile.samples

    @property
    def psnr(self) -> float:
        """dB before rounding to samples, over the tiles so far."""
        return 10 * math.log10(self.samples / self.squared_error) if self.squared_error > 0 else math.inf

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
    """Figures of a finished stream, as in `Encoded`."""

    bytes: int
    part_bytes: dict[str, float]
    seeds: int
    gaussians: int
    lmbda: float


def plan_of(source: Source, settings: EncodeSettings) -> Plan:
    """The plan of an opened picture. The samples of floats are read once, for their range."""
    header = source.header
    shape = (source.width, source.height, source.channels, header.count, source.dtype)
    return stream_plan(Shape(*shape, source.sample_range, source.metadata, source.nodata), settings)


def run_on_cluster(source: Source, plan: Plan, cluster: Cluster, place: str | None) -> Runner:
    """Fits tiles on a cluster, whose workers read the picture at `place`, or are sent their pixels if it is None."""
    if place is None:
        return lambda numbers: cluster.run(TileTask(plan), numbers, _windows(source, plan))
    return lambda numbers: cluster.run(ReadingTask(plan, place), numbers, lambda _: None)


def _windows(source: Source, plan: Plan) -> Callable[[int], Picture]:
    """Reads what a tile covers, with no more metadata than a fit needs."""
    grid = plan.header.grid
    return lambda number: replace(source.read(*grid.rect(number)), metadata=plan.place_of_windows)


def run_tiles(source: Source, plan: Plan, workers: int, threads: int) -> Runner:
    """Fits tiles in this process, or in several that are sent their pixels; `threads` are shared among them."""
    task = TileTask(replace(plan, settings=replace(plan.settings, threads=max(1, threads // workers))))
    window = _windows(source, plan)
    if workers == 1:
        return lambda numbers: run_here(task, numbers, window)
    return lambda numbers: run_in_processes(task, numbers, window, workers)


def encode_source(
    plan: Plan,
    runner: Runner,
    journal: Journal,
    target: Path | BinaryIO,
    on_state: Callable[[State], None] | None = None,
) -> Totals:
    """Fits the tiles that the journal lacks and writes the stream, the same whoever fitted them in whatever order.

    Raises TileFailedError; the journal then has what was finished.
    """
    grid = plan.header.grid
    state = State(grid.count, plan.header.width * plan.header.height)
    for number, tile in journal.tiles.items():
        state.add(tile, _area(plan, number), fresh=False)
    if on_state is not None:
        on_state(state)
    for number, tile in runner([n for n in range(grid.count) if n not in journal.tiles]):
        journal.add(number, tile)
        state.add(tile, _area(plan, number), fresh=True)
        if on_state is not None:
            on_state(state)
    if isinstance(target, Path):
        with whole_file(target) as file:
            size = _write(file, plan, journal)
    else:
        size = _write(target, plan, journal)
    parts: Counter[str] = Counter()
    for tile in journal.tiles.values():
        parts.update(tile.part_bytes)
    seeds = sum(tile.seeds for tile in journal.tiles.values())
    return Totals(size, dict(parts), seeds, seeds * plan.header.spec.per_seed, fit_lmbda(plan.settings))


def _write(file: BinaryIO, plan: Plan, journal: Journal) -> int:
    return write_stream(file, plan.header, plan.software, plan.metadata, journal.payloads())


def _area(plan: Plan, number: int) -> int:
    _, _, width, height = plan.header.grid.core(number)
    return width * height
