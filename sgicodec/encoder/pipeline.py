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
from typing import TYPE_CHECKING, Any, BinaryIO

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
from sgicodec.encoder.tiles.passes import tile_pass
from sgicodec.encoder.tiles.runner import TileRunner, one_blas_thread, within_memory
from sgicodec.encoder.tiles.store import Store, Version
from sgicodec.encoder.tiles.tasks import FitTask
from sgicodec.errors import TargetMissedError, UsageError
from sgicodec.executors.executor import Executor
from sgicodec.files.lock import locked
from sgicodec.files.whole import whole_file
from sgicodec.metrics.distortion import decibels, squared_error
from sgicodec.metrics.visual_score import visual_score
from sgicodec.picture import Picture, to_rgb8
from sgicodec.profiles.default import lmbda_of_quality
from sgicodec.rate_control.quality_search import searched_quality
from sgicodec.rate_control.target import Measured, RateTarget

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
        request = _Request(windows, plan, with_graphics, where, listener, device, verify)
        return _encoded(request, executor, store)


def encode_all_channels(picture: Picture, settings: EncodeSettings, device: Device = ALL_CORES) -> bytes:
    """The stream of a picture in memory with all its channels, an alpha that says nothing too, and none of it divided:
    for those who promise a shape. Raises as `encode_picture`.
    """
    windows = windows_of(picture)
    plan = stream_plan(windows.shape, settings)
    return _encoded(_Request(windows, plan, _undivided, None, NullListener(), device, False)).data


def _undivided(windows: Windows, plan: Plan) -> Division:
    asked = plan.settings.max_error
    return Division(windows, plan, None if asked is None else Layer(windows, asked))


_SEED_QUALITIES = 4
"""Steps of quality between those at which seeds are fitted on the way to a target. Half an octave of λ beside that of
texture costs nothing: two octaves cost 0.1 dB (docs/notes/2026-11-texture.md)."""


@dataclass(frozen=True)
class _Request:
    """What `encode_picture` was asked for. divided: what tiles show of the picture, and what a residual layer does."""

    windows: Windows
    plan: Plan
    divided: Callable[[Windows, Plan], Division]
    output: Path | BinaryIO | None
    listener: NullListener
    device: Device
    verify: bool

    @property
    def target(self) -> RateTarget | None:
        """What the stream is to end at."""
        return self.plan.settings.rate_target(self.plan.header.width * self.plan.header.height)

    def at_quality(self, quality: float, **changes: Any) -> Plan:
        """The plan at a quality, also one beyond those that have a name, without its target, of which the stream tells
        nevertheless. Seeds are those of a round number: sizes follow the texture, which moves less by chance.
        """
        seeds = _SEED_QUALITIES * round(quality / _SEED_QUALITIES)
        named: dict[str, float] = {"quality": seeds} if 1 <= seeds <= 100 else {"lmbda": lmbda_of_quality(seeds)}
        settings = self.plan.settings.without_target(**named, tune=self.plan.settings.tuned_for, **changes)
        plan = stream_plan(self.windows.shape, settings)
        return replace(plan, software=self.plan.software, texture_lmbda=lmbda_of_quality(quality))

    def psnr(self, stream: bytes | Path | BinaryIO) -> float:
        """PSNR in dB over all samples of what a stream decodes to, but for colours where alpha is 0. Raises StreamError
        if it does not decode.
        """
        read, header = self.windows.read, self.plan.header
        with open_stream(stream, self.device.processor) as opened:
            error = sum(squared_error(read(0, top, band.width, band.height), band) for top, band in opened.bands())
        return decibels(error, header.width * header.height * header.spec.channels)

    def verified(self, stream: bytes | Path | BinaryIO) -> float:
        """The PSNR of a finished stream. The listener gets to know."""
        self.listener.stage("verify")
        return self.psnr(stream)

    def score(self, stream: BinaryIO) -> float:
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
    plan, windows, listener = request.plan, request.windows, request.listener
    executor, memory = within_memory(windows, plan, executor)
    listener.planned(plan, executor.workers, memory)
    listener.stage("load")
    tiles = store if store is not None and plan.header.tile else Store()  # one tile cannot be resumed

    with one_blas_thread(), tiles.opened(lambda: fingerprint(plan, windows.digest())):
        streams = _Streams(request, executor, tiles)
        finished, missed = (streams.of(plan), None) if request.target is None else streams.nearest(request.target)
        data, size, psnr = request.write(lambda file: finished.write(file, tiles))
        encoded = replace(_summary(data, size, finished, tiles), psnr=psnr)
    masked = plan.header.masked
    if masked is not None and not encoded.part_bytes.keys() - {"mask", "overview", "residual"}:
        listener.note(_NOTHING[masked])
    if missed is not None:
        raise TargetMissedError(missed, encoded)
    return encoded


@dataclass(frozen=True)
class _Finished:
    """A stream but for the payloads of its tiles. plan: that of its header; chosen: which coding of each tile it takes;
    overview: a stream of its own.
    """

    plan: Plan
    chosen: list[Version]
    overview: bytes | None
    residual: bytes | None = None

    def write(self, file: BinaryIO, store: Store) -> int:
        """Writes the stream; returns its length."""
        plan, tiles = self.plan, map(store.payload, self.chosen)
        return write_stream(file, plan.header, plan.software, plan.metadata, tiles, self.overview, self.residual)


class _Streams:
    """Streams of one picture, a pass over its tiles each."""

    def __init__(self, request: _Request, executor: Executor, store: Store) -> None:
        self._request, self._executor, self._store = request, executor, store
        self._passes = 0

    def of(self, plan: Plan, name: str = "tiles") -> _Finished:
        """The stream of a plan, whatever its target. Raises TileFailedError; the store then has what was finished."""
        request, index = self._request, self._passes
        self._passes += 1
        below, plan, layer = request.divided(request.windows, plan)
        if request.target is None:  # which looks as it will: λ alone moves sizes by as little as is wanted
            plan = with_quality_calibration(below, plan)
        runner, reporter = TileRunner(below, plan, self._executor, request.device), PassReporter(plan, request.listener)
        overview = self._overview(plan, index, runner, reporter) if takes_overview(plan) else None
        task = FitTask(plan) if plan.header.tile else FitTask(plan, request.listener)
        numbers = range(plan.header.grid.count)
        chosen = tile_pass(name, index, task, numbers, runner, self._store, reporter)
        header = self._store.tiles[chosen[-1]].header
        finished = _Finished(plan if header is None else replace(plan, header=header), chosen, overview)
        return finished if layer is None else replace(finished, residual=self._residual(finished, layer))

    def nearest(self, target: RateTarget) -> tuple[_Finished, str | None]:
        """The stream that comes nearest to a target, and how it misses that, if it does."""
        request, settings, tried = self._request, self._request.plan.settings, dict[float, tuple[_Finished, Measured]]()

        def measure(quality: float) -> Measured:
            finished = self.of(request.at_quality(quality))
            tried[quality] = finished, self._measured(finished, target)
            return tried[quality][1]

        def draft(quality: float) -> Measured:
            plan = request.at_quality(quality, effort=1, overview=False)
            return self._measured(self.of(plan, "drafts"), target)

        has_drafts = settings.steps is None and settings.effort > 1
        ending = request.listener.ending if not request.plan.header.tile else lambda: False
        finished, measured = tried[searched_quality(target, measure, draft if has_drafts else None, ending)]
        return finished, target.miss_message(measured) if target.is_missed(measured) else None

    def _measured(self, finished: _Finished, target: RateTarget) -> Measured:
        """What a stream is, as far as the target asks."""
        with tempfile.TemporaryFile() as file:
            size = finished.write(file, self._store)
            file.seek(0)
            return target.measure(size, lambda: self._request.psnr(file), lambda: self._request.score(file))

    def _overview(self, plan: Plan, index: int, runner: TileRunner, reporter: PassReporter) -> bytes:
        def made() -> bytes:
            reporter.begin("overview", [], {})
            task = _OverviewTask(overview_settings(plan, plan.settings.fit_settings().lmbda))
            return dict(runner(task, [0], window=overview_picture(plan, self._request.windows.read)))[0]

        return self._store.cached(f"overview {index}", made)

    def _residual(self, finished: _Finished, layer: Layer) -> bytes:
        """The payload of the residual layer."""
        self._request.listener.stage("residual")
        with tempfile.TemporaryFile() as file:
            finished.write(file, self._store)
            file.seek(0)
            with open_stream(file, self._request.device.processor) as stream:
                return residual_layer(stream, layer, self._request.device)


@dataclass(frozen=True)
class _OverviewTask:
    """Encodes a picture as a stream of its own."""

    settings: EncodeSettings

    def __call__(self, number: int, window: Picture, device: Device) -> bytes:
        """The stream of `window`."""
        return encode_all_channels(window, self.settings, device)


def _summary(data: bytes, size: int, finished: _Finished, store: Store) -> Encoded:
    """The figures of a stream from those of its tiles."""
    tiles = [store.tiles[version] for version in finished.chosen]
    parts: Counter[str] = Counter()
    for tile in tiles:
        parts.update(tile.part_bytes)
    if finished.overview:
        parts["overview"] = len(finished.overview)
    if finished.residual:
        parts["residual"] = len(finished.residual)
    seeds = sum(tile.seeds for tile in tiles)
    steps = [tile.steps for tile in tiles if tile.steps]
    return Encoded(
        data,
        dict(parts),
        seeds,
        seeds * finished.plan.header.spec.per_seed,
        tiles[-1].lmbda,
        round(sum(steps) / max(1, len(steps))),
        any(tile.ended_early for tile in tiles),
        devices=dict(Counter(tile.fitted_by for tile in tiles if tile.fitted_by)),
        written=size,
    )
