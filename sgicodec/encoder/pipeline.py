"""From a picture to a stream: in memory or opened, in one tile or in several, one pipeline."""

from __future__ import annotations

import io
import time
from collections import Counter
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass, replace
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ALL_CORES, Device, check_device
from sgicodec.encoder.alpha import without_needless_alpha
from sgicodec.encoder.blas_threads import one_blas_thread
from sgicodec.encoder.checkpoint import fingerprint
from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.interfaces import Finished, Runner, Store
from sgicodec.encoder.listener import NullListener, PassReporter
from sgicodec.encoder.measure import measured_error, measured_psnr
from sgicodec.encoder.memory import estimate
from sgicodec.encoder.nodata import empty_pixels
from sgicodec.encoder.overview import overview_picture, overview_settings, takes_overview
from sgicodec.encoder.passes import TilePasses
from sgicodec.encoder.plan import Plan, stream_plan
from sgicodec.encoder.same_look import with_same_look
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.store import MemoryStore
from sgicodec.encoder.tile_weight import tile_weight
from sgicodec.encoder.tile_work import FitTask, Start
from sgicodec.encoder.time_budget import TimeBudget
from sgicodec.encoder.windows import Windows, kept, tile_window, windows_of
from sgicodec.encoder.worker import TileRunner
from sgicodec.errors import TargetMissedError, UsageError
from sgicodec.executors.executor import Executor, Memory
from sgicodec.executors.serial import SerialExecutor
from sgicodec.image.files import whole_file
from sgicodec.image.lock import locked
from sgicodec.picture import Picture, nodata_samples

if TYPE_CHECKING:
    from sgicodec.bitstream.header import Header
    from sgicodec.image import Source

__all__ = ["encode_all_channels", "encode_picture"]


def encode_picture(
    picture: Picture | Source,
    settings: EncodeSettings | None = None,
    *,
    output: str | Path | BinaryIO | None = None,
    executor: Executor | None = None,
    store: Store | None = None,
    progress: NullListener | None = None,
    device: Device = ALL_CORES,
    verify: bool = False,
    started: float | None = None,
) -> Encoded:
    """Encodes a picture that is in memory, or one that `open_source` opened and that need not fit into it.

    A picture in one tile is fitted whole, by this process. Of several tiles, as many are in memory as `executor` works
    on at once (by default one, in this process), and `store` keeps the finished ones (in memory; a `Checkpoint`
    survives a kill). `progress` gets reports. `device` is what computes.

    The stream is written to `output`, a path or a file object, else it is the result's `data`. `verify` decodes it and
    measures its PSNR, unless it went to a file object. Equal input, settings and version give equal bytes, whatever
    executes, unless time is the limit: that runs from `started` on, a value of time.monotonic(), or from this call.

    While it runs, the path of `output` is locked: OutputLockedError where another encode writes it.

    Raises TargetMissedError, with the nearest stream, for a size or quality that cannot be reached; PictureError for
    what cannot be read or no stream can hold; UsageError for a range of samples that integers do not have;
    TileFailedError, after which the store has what was finished.
    """
    started = time.monotonic() if started is None else started
    windows = windows_of(picture)
    listener = progress or NullListener()
    check_device(device)
    if not isinstance(settings, EncodeSettings | None):
        raise UsageError(f"settings {settings!r}; they must be EncodeSettings")
    plan = stream_plan(windows.shape, settings or EncodeSettings())
    if not plan.header.tile:
        _memory_of_whole(windows, plan, executor)
        windows = kept(windows)
    if windows.shape.remark is not None:
        listener.note(windows.shape.remark)
    windows, plan = without_needless_alpha(windows, plan, listener)
    where = Path(output) if isinstance(output, str) else output
    with locked(where) if isinstance(where, Path) else nullcontext():
        job = _Job(windows, with_same_look(windows, plan), where, listener, device, verify, started)
        return _encoded(job, executor, store)


def encode_all_channels(picture: Picture, settings: EncodeSettings, device: Device = ALL_CORES) -> bytes:
    """The stream of a picture in memory with all its channels, an alpha that says nothing too: for those who promise
    a shape. Raises as `encode_picture`.
    """
    windows = windows_of(picture)
    plan = with_same_look(windows, stream_plan(windows.shape, settings))
    return _encoded(_Job(windows, plan, None, NullListener(), device, False, time.monotonic())).data


def _encoded(job: _Job, executor: Executor | None = None, store: Store | None = None) -> Encoded:
    """Raises TargetMissedError, with the nearest stream."""
    masked = job.plan.header.masked
    with one_blas_thread():
        encoded, missed = _encode_tiles(job, executor, store) if job.plan.header.tile else _encode_whole(job, executor)
    if masked is not None and not encoded.part_bytes.keys() - {"mask", "overview"}:
        job.listener.note(_NOTHING[masked])
    if missed is not None:
        raise TargetMissedError(missed, encoded)
    return encoded


@dataclass(frozen=True)
class _Job:
    """What `encode` was asked for."""

    windows: Windows
    plan: Plan
    output: Path | BinaryIO | None
    listener: NullListener
    device: Device
    verify: bool
    started: float

    @property
    def verifies(self) -> bool:
        """Whether the stream is decoded, which must be readable then."""
        return self.verify and (self.output is None or isinstance(self.output, Path))

    def psnr(self, stream: bytes | Path) -> float:
        """Of a finished stream, in dB. Raises StreamError if it does not decode."""
        self.listener.stage("verify")
        with open_stream(stream, self.device.processor) as opened:
            return measured_psnr(opened, self.windows)

    def write(self, to: Callable[[BinaryIO], int]) -> tuple[bytes, int, float | None]:
        """Has a stream written to the output, a path's whole or not at all; returns its data if there is none, its
        length, and its PSNR if it is verified, which a file is before it gets its name.
        """
        if isinstance(self.output, Path):
            with whole_file(self.output) as file:
                size = to(file)
                file.flush()
                written = Path(file.name)
                return b"", size, self.psnr(written) if self.verifies and written.is_file() else None
        if self.output is not None:
            size = to(self.output)
            self.output.flush()
            return b"", size, None
        buffer = io.BytesIO()
        size = to(buffer)
        return buffer.getvalue(), size, self.psnr(buffer.getvalue()) if self.verifies else None


_NOTHING = {
    "nodata": "every pixel has the nodata value; the stream holds no picture",
    "transparent": "alpha is 0 everywhere and there are no colours; the stream holds no picture",
}


def _encode_whole(job: _Job, executor: Executor | None) -> tuple[Encoded, str | None]:
    """The stream of a picture in one tile, and how it misses what was asked for, if it does. An executor has a say in
    the memory that this takes.
    """
    shape, plan = job.windows.shape, job.plan
    job.listener.planned(plan, 1, _memory_of_whole(job.windows, plan, executor))
    job.listener.stage("load")
    picture = job.windows.read(0, 0, shape.width, shape.height)
    plan = replace(plan, header=_header_of_whole(plan.header, picture))
    job.listener.stage("prepare")
    tile = FitTask(plan, job.listener, job.started)(0, plan.of_header(picture), Start(), job.device)
    buffer = io.BytesIO()
    write_stream(buffer, tile.header or plan.header, plan.software, plan.metadata, [tile.payload])
    data = buffer.getvalue()
    psnr = job.psnr(data) if job.verify else None
    if job.output is not None:
        replace(job, verify=False).write(lambda file: file.write(data))
    devices = {tile.fitted_by: 1} if tile.fitted_by else {}
    gaussians = tile.seeds * plan.header.spec.per_seed
    encoded = Encoded(
        data, tile.part_bytes, tile.seeds, gaussians, tile.lmbda, tile.steps, tile.ended_early, psnr, devices
    )
    return encoded, tile.missed


def _header_of_whole(header: Header, picture: Picture) -> Header:
    """The header of a picture in one tile, which says of masks no more than it needs. A number that is nodata stays,
    even where no sample has it: none may become it.
    """
    if header.masked == "nodata":
        nodata = nodata_samples(picture)
        masked, differ = nodata.any() or not isnan(header.nodata), bool((nodata != nodata[..., :1]).any())
    else:
        masked, differ = empty_pixels(picture, header.masked).any(), False
    return replace(header, masked=header.masked if masked else None, has_band_masks=differ)


def _memory_of_whole(windows: Windows, plan: Plan, executor: Executor | None) -> Memory:
    """What a picture in one tile takes. Raises UsageError for more than an executor may."""
    memory = estimate(plan, windows.memory(windows.shape.width, windows.shape.height))
    (executor or SerialExecutor()).within(memory, 1)
    return memory


def _encode_tiles(job: _Job, executor: Executor | None, store: Store | None) -> tuple[Encoded, str | None]:
    """The same of a picture in several tiles. Does what the store lacks."""
    plan, grid = job.plan, job.plan.header.grid
    memory = estimate(plan, job.windows.memory(*grid.rect(0)[2:]))
    executor = (executor or SerialExecutor()).within(memory, grid.count)
    job.listener.planned(plan, executor.workers, memory)
    job.listener.stage("load")
    runner = TileRunner(job.windows, plan, executor, job.device)

    def error_of(file: BinaryIO) -> float:
        with open_stream(file, job.device.processor) as stream:
            return measured_error(stream, job.windows)

    tiles = store or MemoryStore()
    with tiles.opened(lambda: fingerprint(plan, job.windows.digest())):
        reporter, budget = PassReporter(plan, job.listener), _time_budget(job, executor.workers)
        overview = _overview_maker(plan, job.windows, runner)
        found = TilePasses(plan, runner, tiles, reporter, error_of, budget, overview).run()
        data, size, psnr = job.write(lambda file: _write(file, found, tiles))
    return replace(_summary(data, size, found, tiles), psnr=psnr), found.missed


def _time_budget(job: _Job, workers: int) -> TimeBudget | None:
    """The time of each tile, where that is the limit."""
    limit, plan = job.plan.settings.time_limit, job.plan
    if limit is None:
        return None
    decoders = job.device.cores if job.verifies else 0

    def weigh(number: int) -> float:
        return tile_weight(tile_window(job.windows, plan, number), plan)

    return TimeBudget(plan.header.grid, job.started + limit, workers, decoders, weigh)


def _write(file: BinaryIO, found: Finished, store: Store) -> int:
    plan = found.plan
    tiles = map(store.payload, found.chosen)
    return write_stream(file, plan.header, plan.software, plan.metadata, tiles, found.overview)


def _summary(data: bytes, size: int, found: Finished, store: Store) -> Encoded:
    """The figures of a stream from those of its tiles."""
    tiles = [store.tiles[version] for version in found.chosen]
    parts: Counter[str] = Counter()
    for tile in tiles:
        parts.update(tile.part_bytes)
    if found.overview:
        parts["overview"] = len(found.overview)
    seeds = sum(tile.seeds for tile in tiles)
    steps = [tile.steps for tile in tiles if tile.steps]
    mean = round(sum(steps) / max(1, len(steps)))
    gaussians = seeds * found.plan.header.spec.per_seed
    by_tile = {version.tile: tile.fitted_by for version, tile in store.tiles.items() if tile.fitted_by}
    devices = dict(Counter(by_tile.values()))
    return Encoded(data, dict(parts), seeds, gaussians, found.lmbda, mean, devices=devices, written=size)


@dataclass(frozen=True)
class _OverviewTask:
    """Encodes a picture as a stream of its own."""

    settings: EncodeSettings

    def __call__(self, number: int, window: Picture, start: Start, device: Device) -> bytes:
        """The stream of `window`."""
        return encode_all_channels(window, self.settings, device)


def _overview_maker(plan: Plan, windows: Windows, runner: Runner) -> Callable[[float], bytes] | None:
    """What makes the overview of a stream whose tiles are fitted at a λ, if it is to have one."""

    def made(lmbda: float) -> bytes:
        task = _OverviewTask(overview_settings(plan, lmbda))
        return dict(runner(task, [0], lambda _: Start(), overview_picture(plan, windows.read)))[0]

    return made if takes_overview(plan) else None
