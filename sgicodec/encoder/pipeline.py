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

from sgicodec.device import ALL_CORES, Device, check_device
from sgicodec.encoder.input.windows import kept, windows_of, without_needless_alpha
from sgicodec.encoder.plan import stream_plan
from sgicodec.encoder.progress import NullListener
from sgicodec.encoder.residual.choice import fixed_division, way_to_divide
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.streams import Finished, Request, Streams
from sgicodec.encoder.tiles.checkpoint import fingerprint
from sgicodec.encoder.tiles.memory import within_memory
from sgicodec.encoder.tiles.runner import one_blas_thread
from sgicodec.encoder.tiles.store import Store
from sgicodec.errors import TargetMissedError, UsageError
from sgicodec.executors.executor import Executor
from sgicodec.files.lock import locked
from sgicodec.files.whole import whole_file
from sgicodec.picture import Picture

if TYPE_CHECKING:
    from sgicodec.image.source import Source


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
    size: int = 0
    """Bytes of the stream, whose data may be in an output."""


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
    within_memory(windows, plan, executor)  # before memory is taken
    if not plan.header.tile:
        windows = kept(windows)
    if windows.shape.remark is not None:
        listener.note(windows.shape.remark)
    windows, plan = without_needless_alpha(windows, plan, listener)
    where = Path(output) if isinstance(output, str) else output
    with locked(where) if isinstance(where, Path) else nullcontext():
        request = Request(windows, plan, way_to_divide(windows, plan, listener), listener, device)
        if plan.header.tile and not isinstance(picture, Picture):  # one tile is read at once
            request = replace(request, check_unchanged=picture.check_unchanged)
        return _encoded(request, _Output(where, request.verified if verify else None), executor, store)


def encode_all_channels(picture: Picture, settings: EncodeSettings, device: Device = ALL_CORES) -> bytes:
    """The stream of a picture in memory with all its channels, an alpha that says nothing too, without a residual layer
    but for classes: for those who promise a shape. Raises as `encode_picture`.
    """
    windows = windows_of(picture)
    plan = stream_plan(windows.shape, settings)
    return _encoded(Request(windows, plan, fixed_division, NullListener(), device), _Output(None)).data


@dataclass(frozen=True)
class _Output:
    """Where a stream goes, None for into memory; verified: its PSNR, if it is to be known."""

    to: Path | BinaryIO | None
    verified: Callable[[bytes | Path | BinaryIO], float] | None = None

    def write(self, stream: Callable[[BinaryIO], int]) -> tuple[bytes, int, float | None]:
        """Has a stream written there, to a path whole or not at all; returns its data if there is no such place, its
        length, and its PSNR if it is to be verified, which it is before anybody else sees it.
        """
        to, verified = self.to, self.verified
        if to is None:
            buffer = io.BytesIO()
            size = stream(buffer)
            return buffer.getvalue(), size, None if verified is None else verified(buffer.getvalue())
        if verified is None:
            with _opened(to) as file:
                return b"", stream(file), None
        if isinstance(to, Path) and (to.is_file() or not to.exists()):
            with whole_file(to) as file:
                size = stream(file)
                file.flush()
                return b"", size, verified(Path(file.name))
        with tempfile.TemporaryFile() as file, _opened(to) as output:
            size = stream(file)
            file.seek(0)
            psnr = verified(file)
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


def _encoded(
    request: Request, output: _Output, executor: Executor | None = None, store: Store | None = None
) -> Encoded:
    """Raises TargetMissedError, with the nearest stream."""
    plan, windows, listener = request.plan, request.windows, request.listener
    executor, memory = within_memory(windows, plan, executor)
    listener.planned(plan, executor.workers, memory)
    listener.stage("load")
    tiles = store if store is not None and plan.header.tile else Store()  # one tile cannot be resumed

    with one_blas_thread(), tiles.opened(lambda: fingerprint(plan, windows.digest())):
        streams = Streams(request, executor, tiles, _overview)
        finished, missed = (streams.of(plan), None) if request.target is None else streams.nearest(request.target)
        request.check_unchanged()
        data, size, psnr = output.write(lambda file: finished.write(file, tiles))
        encoded = replace(_summary(data, size, finished, tiles), psnr=psnr)
    masked = plan.header.masked
    if masked is not None and not encoded.part_bytes.keys() - {"mask", "overview", "residual"}:
        listener.note(_NOTHING[masked])
    if missed is not None:
        raise TargetMissedError(missed, encoded)
    return encoded


def _overview(settings: EncodeSettings, number: int, window: Picture, device: Device) -> bytes:
    """The task of making `window` a stream of its own."""
    return encode_all_channels(window, settings, device)


def _summary(data: bytes, size: int, finished: Finished, store: Store) -> Encoded:
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
        size=size,
    )
