"""From a picture to a stream: in memory or opened, in one tile or in several, one pipeline."""

from __future__ import annotations

import io
import shutil
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ALL_CORES, Device, check_device
from sgicodec.encoder.graphics import Division, with_graphics
from sgicodec.encoder.input.overview import overview_picture, overview_settings, takes_overview
from sgicodec.encoder.input.windows import Windows, kept, windows_of, without_needless_alpha
from sgicodec.encoder.plan import Plan, stream_plan
from sgicodec.encoder.progress import NullListener, PassReporter
from sgicodec.encoder.quality_calibration import with_quality_calibration
from sgicodec.encoder.residual import Layer, residual_layer
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tiles.checkpoint import fingerprint
from sgicodec.encoder.tiles.passes import Finished, TilePasses
from sgicodec.encoder.tiles.runner import TileRunner, one_blas_thread, within_memory
from sgicodec.encoder.tiles.store import Store
from sgicodec.encoder.tiles.tasks import FitTask
from sgicodec.errors import TargetMissedError, UsageError
from sgicodec.executors.executor import Executor
from sgicodec.files.lock import locked
from sgicodec.files.whole import whole_file
from sgicodec.metrics.distortion import decibels, squared_error
from sgicodec.metrics.visual_score import visual_score
from sgicodec.picture import Picture, to_rgb8
from sgicodec.rate_control.step_search import step_shift
from sgicodec.rate_control.target import Measured

if TYPE_CHECKING:
    from sgicodec.image.source import Source

__all__ = ["Encoded", "encode_all_channels", "encode_picture"]


@dataclass(frozen=True)
class Encoded:
    """A finished stream and its figures.

    data: the stream; empty if it went to an output. part_bytes: what each part of the tiles costs.
    seeds, gaussians: how many there are. steps: of the fit, the mean over the tiles that had one. ended_early: whether
    the caller ended the fit. psnr: dB over all samples of what was decoded, but for colours where alpha is 0; None if
    it was not measured. devices: by the name of what fitted, a GPU or the processor, how many tiles it did.
    """

    data: bytes = field(repr=False)
    part_bytes: dict[str, float] = field(repr=False)
    seeds: int
    gaussians: int
    lmbda: float
    steps: int = 0
    ended_early: bool = False
    psnr: float | None = None
    devices: dict[str, int] = field(default_factory=dict, repr=False)
    written: int = 0
    """Bytes of a stream whose data are not here."""

    @property
    def size(self) -> int:
        """Bytes of the stream."""
        return len(self.data) or self.written


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
) -> Encoded:
    """Encodes a picture that is in memory, or one that `open_source` opened and that need not fit into it.

    Of its tiles, as many are in memory as `executor` works on at once (by default one, in this process), and `store`
    keeps the finished ones (in memory; a `Checkpoint` survives a kill). A picture in one tile is fitted in this
    process, in one go. `progress` gets reports. `device` is what computes.

    The stream is written to `output`, a path or a file object, else it is the result's `data`. `verify` decodes it and
    measures its PSNR before anything is written there. Equal input, settings and version give equal bytes, whatever
    executes.

    While it runs, the path of `output` is locked: OutputLockedError where another encode writes it.

    Raises TargetMissedError, with the nearest stream, for a size or quality that cannot be reached; PictureError for
    what cannot be read or no stream can hold; UsageError for a range of samples that integers do not have;
    TileFailedError, after which the store has what was finished.
    """
    windows = windows_of(picture)
    listener = progress or NullListener()
    check_device(device)
    if not isinstance(settings, EncodeSettings | None):
        raise UsageError(f"settings {settings!r}; they must be EncodeSettings")
    plan = stream_plan(windows.shape, settings or EncodeSettings())
    within_memory(windows, plan, executor)
    if not plan.header.tile:
        windows = kept(windows)
    if windows.shape.remark is not None:
        listener.note(windows.shape.remark)
    windows, plan = without_needless_alpha(windows, plan, listener)
    where = Path(output) if isinstance(output, str) else output
    with locked(where) if isinstance(where, Path) else nullcontext():
        settings = plan.settings
        if settings.target is not None and settings.max_error is None:
            first = with_graphics(windows, _at_quality(windows, plan, _FIRST_QUALITY))
            if first.layer is not None:
                request = _Request(windows, windows, plan, None, where, listener, device, verify)
                return _at_target(request, first, executor)
        request = _request(windows, with_graphics(windows, plan), where, listener, device, verify)
        return _encoded(request, executor, store)


def encode_all_channels(picture: Picture, settings: EncodeSettings, device: Device = ALL_CORES) -> bytes:
    """The stream of a picture in memory with all its channels, an alpha that says nothing too: for those who promise
    a shape. Raises as `encode_picture`.
    """
    windows = windows_of(picture)
    plan = with_quality_calibration(windows, stream_plan(windows.shape, settings))
    layer = None if settings.max_error is None else Layer(windows, settings.max_error)
    return _encoded(_Request(windows, windows, plan, layer, None, NullListener(), device, False)).data


@dataclass(frozen=True)
class _Request:
    """What `encode_picture` was asked for, and what follows: `below` is what tiles show of the picture."""

    windows: Windows
    below: Windows
    plan: Plan
    layer: Layer | None
    output: Path | BinaryIO | None
    listener: NullListener
    device: Device
    verify: bool

    def error(self, stream: bytes | Path | BinaryIO) -> float:
        """Squared error over all samples of what a stream decodes to, in 0..1, but for colours where alpha is 0. Raises
        StreamError if it does not decode.
        """
        read = self.windows.read
        with open_stream(stream, self.device.processor) as opened:
            return sum(squared_error(read(0, top, band.width, band.height), band) for top, band in opened.bands())

    def psnr(self, stream: bytes | Path | BinaryIO) -> float:
        """The same as PSNR in dB."""
        header = self.plan.header
        return decibels(self.error(stream), header.width * header.height * header.spec.channels)

    def verified(self, stream: bytes | Path | BinaryIO) -> float:
        """The PSNR of a finished stream. The listener gets to know."""
        self.listener.stage("verify")
        return self.psnr(stream)

    def score(self, stream: bytes) -> float:
        """SSIMULACRA 2 of a finished stream."""
        header = self.plan.header
        with open_stream(stream, self.device.processor) as opened:
            shown = to_rgb8(opened.picture())
        seen = to_rgb8(self.windows.read(0, 0, header.width, header.height))
        return visual_score(seen, shown, self.device.processor)

    def write(self, to: Callable[[BinaryIO], int]) -> tuple[bytes, int, float | None]:
        """Has a stream written to the output, a path's whole or not at all; returns its data if there is none, its
        length, and its PSNR if it is to be verified, which it is before anybody else sees it.
        """
        if self.output is None:
            buffer = io.BytesIO()
            size = to(buffer)
            return buffer.getvalue(), size, self.verified(buffer.getvalue()) if self.verify else None
        if not self.verify:
            with _opened(self.output) as file:
                return b"", to(file), None
        if isinstance(self.output, Path) and (self.output.is_file() or not self.output.exists()):
            with whole_file(self.output) as file:
                size = to(file)
                file.flush()
                return b"", size, self.verified(Path(file.name))
        with tempfile.TemporaryFile() as file, _opened(self.output) as output:
            size = to(file)
            file.seek(0)
            psnr = self.verified(file)
            file.seek(0)
            shutil.copyfileobj(file, output)
            return b"", size, psnr


def _request(
    windows: Windows,
    division: Division,
    output: Path | BinaryIO | None,
    listener: NullListener,
    device: Device,
    verify: bool,
) -> _Request:
    """One of a picture that is divided in two."""
    below, plan, layer = division
    plan = with_quality_calibration(below, plan)
    return _Request(windows, below, plan, layer, output, listener, device, verify)


@contextmanager
def _opened(output: Path | BinaryIO) -> Iterator[BinaryIO]:
    if isinstance(output, Path):
        with whole_file(output) as file:
            yield file
        return
    yield output
    output.flush()


_NOTHING = {
    "nodata": "every pixel has the nodata value; the stream holds no picture",
    "transparent": "alpha is 0 everywhere and there are no colours; the stream holds no picture",
}


def _encoded(request: _Request, executor: Executor | None = None, store: Store | None = None) -> Encoded:
    """Raises TargetMissedError, with the nearest stream."""
    plan, windows, listener = request.plan, request.below, request.listener
    executor, memory = within_memory(windows, plan, executor)
    listener.planned(plan, executor.workers, memory)
    listener.stage("load")
    runner = TileRunner(windows, plan, executor, request.device)
    tiles = store if store is not None and plan.header.tile else Store()  # one tile cannot be resumed

    with one_blas_thread(), tiles.opened(lambda: fingerprint(plan, windows.digest())):
        task = FitTask(plan) if plan.header.tile else FitTask(plan, listener)
        reporter, overview = PassReporter(plan, listener), _overview_maker(plan, request.windows, runner)
        finished = TilePasses(task, runner, tiles, reporter, request.error, overview).run()
        layer = _residual(request, finished, tiles)
        data, size, psnr = request.write(lambda file: _write(file, finished, tiles, layer))
        encoded = replace(_summary(data, size, finished, tiles, layer), psnr=psnr)
    masked = plan.header.masked
    if masked is not None and not encoded.part_bytes.keys() - {"mask", "overview", "residual"}:
        listener.note(_NOTHING[masked])
    if finished.missed is not None:
        raise TargetMissedError(finished.missed, encoded)
    return encoded


_FIRST_QUALITY, _STEPS_OF_SHIFT = 60.0, 0.5
"""Of the streams that `_at_target` tries: the first, and steps of quality for a unit of the shift."""


def _at_target(request: _Request, first: Division, executor: Executor | None) -> Encoded:
    """The nearest of whole streams at one quality after another: what a residual layer shows of a picture, none of its
    tiles can measure. first: at the first quality. Raises TargetMissedError with it.
    """
    plan, windows, tried = request.plan, request.windows, dict[float, tuple[Encoded, Measured]]()
    target = plan.settings.rate_target(plan.header.width * plan.header.height)
    assert target is not None

    def measure(shift: float) -> Measured:
        quality = min(max(_FIRST_QUALITY - _STEPS_OF_SHIFT * shift, 1.0), 100.0)
        division = with_graphics(windows, _at_quality(windows, plan, quality)) if shift else first
        encoded = _encoded(_request(windows, division, None, request.listener, request.device, False), executor)
        data = encoded.data
        measured = target.measure(len(data), lambda: request.psnr(data), lambda: request.score(data))
        tried[shift] = encoded, measured
        return measured

    found, measured = tried[step_shift(target, measure)]
    data, size, psnr = request.write(lambda file: file.write(found.data))
    encoded = replace(found, data=data, written=size, psnr=psnr)
    if target.is_missed(measured):
        raise TargetMissedError(target.miss_message(measured), encoded)
    return encoded


def _at_quality(windows: Windows, plan: Plan, quality: float) -> Plan:
    """The plan at a quality, without its target, of which the stream tells nevertheless."""
    settings = plan.settings.without_target(quality=quality, tune=plan.settings.tuned_for)
    return replace(stream_plan(windows.shape, settings), software=plan.software)


def _residual(request: _Request, finished: Finished, store: Store) -> bytes | None:
    """The payload of the residual layer, if there is to be one."""
    if request.layer is None:
        return None
    request.listener.stage("residual")
    with tempfile.TemporaryFile() as file:
        _write(file, finished, store, None)
        file.seek(0)
        with open_stream(file, request.device.processor) as stream:
            return residual_layer(stream, request.layer, request.device)


def _write(file: BinaryIO, finished: Finished, store: Store, residual: bytes | None) -> int:
    plan = finished.plan
    tiles = map(store.payload, finished.chosen)
    return write_stream(file, plan.header, plan.software, plan.metadata, tiles, finished.overview, residual)


def _summary(data: bytes, size: int, finished: Finished, store: Store, residual: bytes | None) -> Encoded:
    """The figures of a stream from those of its tiles."""
    tiles = [store.tiles[version] for version in finished.chosen]
    parts: Counter[str] = Counter()
    for tile in tiles:
        parts.update(tile.part_bytes)
    if finished.overview:
        parts["overview"] = len(finished.overview)
    if residual:
        parts["residual"] = len(residual)
    seeds = sum(tile.seeds for tile in tiles)
    steps = [tile.steps for tile in tiles if tile.steps]
    by_tile = {version.tile: tile.fitted_by for version, tile in store.tiles.items() if tile.fitted_by}
    return Encoded(
        data,
        dict(parts),
        seeds,
        seeds * finished.plan.header.spec.per_seed,
        finished.lmbda,
        round(sum(steps) / max(1, len(steps))),
        any(tile.ended_early for tile in tiles),
        devices=dict(Counter(by_tile.values())),
        written=size,
    )


@dataclass(frozen=True)
class _OverviewTask:
    """Encodes a picture as a stream of its own."""

    settings: EncodeSettings

    def __call__(self, number: int, window: Picture, start: bytes, device: Device) -> bytes:
        """The stream of `window`."""
        return encode_all_channels(window, self.settings, device)


def _overview_maker(plan: Plan, windows: Windows, runner: TileRunner) -> Callable[[float], bytes] | None:
    """What makes the overview of a stream whose tiles are fitted at a λ, if it is to have one."""

    def made(lmbda: float) -> bytes:
        task = _OverviewTask(overview_settings(plan, lmbda))
        return dict(runner(task, [0], window=overview_picture(plan, windows.read)))[0]

    return made if takes_overview(plan) else None
