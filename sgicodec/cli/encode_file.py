"""One picture of `sgi encode`: opened, encoded by one call of the library, reported."""

from __future__ import annotations

import os
import sys
import time
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from sgicodec.cli.encode_listener import EncodeListener
from sgicodec.cli.paths import STANDARD, display, given, is_written_directly, writing
from sgicodec.cli.report import Report, print_report
from sgicodec.cuda.choice import device_of
from sgicodec.encoder.tiles.checkpoint import Checkpoint
from sgicodec.errors import TargetMissedError, UsageError
from sgicodec.executors.executor import MIB
from sgicodec.executors.peak import own_peak
from sgicodec.executors.processes import ProcessExecutor
from sgicodec.files.scratch import scratch_folder
from sgicodec.image.source import open_to_encode

if TYPE_CHECKING:
    from sgicodec.cli.batch import Files
    from sgicodec.device import Device
    from sgicodec.encoder.plan import Plan
    from sgicodec.encoder.settings import EncodeSettings
    from sgicodec.executors.executor import Executor
    from sgicodec.image.opened import Alpha
    from sgicodec.image.source import Source
    from sgicodec.image.used_range import RangeChoice


@dataclass(frozen=True)
class EncodeOptions:
    """What the options of `sgi encode` say of each picture."""

    files: Files
    settings: EncodeSettings
    """What the stream is to be."""
    device: Device
    """What computes in this process."""
    device_name: str
    """What was asked for, which workers of a cluster find on their machines."""
    verbose: bool
    sample_range: RangeChoice | None
    """The samples that stand for 0 and 1, None for what suits the picture."""
    alpha: Alpha
    """What a last band is taken for."""
    page: int | None
    """Which page of a file that holds several, from 1; None for the first."""
    max_memory: float | None
    """Bytes of all processes together, None for any."""
    cluster: str | None
    """Address of a Dask cluster that fits tiles."""
    source_at: str | None
    """Path or URL of the picture as the cluster sees it."""
    send_pixels: bool
    """Whether the cluster is sent pixels and reads nothing."""
    resume: bool
    """Whether to go on with an interrupted encode."""
    verify: bool
    """Whether the stream is decoded and measured."""


def encode_file(origin: str, target: str, options: EncodeOptions, started: float) -> int:
    """Encodes one picture, a path, a URL or - for stdin, and prints the report; returns the stream's bytes. target: the
    same, - for stdout; started: a value of time.monotonic().

    Raises TargetMissedError, after all of that, for a target that was missed.
    """
    from sgicodec._native import keep_freed_memory

    keep_freed_memory()
    files = options.files
    files.check(origin, target, "stream")
    data, missed = given(origin), None
    with ExitStack() as stack:
        listener = EncodeListener(files.mode, files.quiet, options.cluster is not None, origin)
        samples: dict[str, Any] = {"sample_range": options.sample_range, "alpha": options.alpha, "page": options.page}
        keeps = options.max_memory is None
        source = stack.enter_context(open_to_encode(data, listener.note, **samples, option="--page", keeps=keeps))
        executor = _executor(origin, options, source, stack)
        device = device_of(options.device_name, options.device.threads) if executor is None else options.device
        checkpoint = Checkpoint(_part(target, stack), options.resume, files.force)
        output: Path | BinaryIO = sys.stdout.buffer if target == STANDARD else Path(target)
        from sgicodec.encoder.pipeline import encode_picture

        try:
            with listener, writing(target):
                encoded = encode_picture(
                    source,
                    options.settings,
                    output=output,
                    executor=executor,
                    store=checkpoint,
                    progress=listener,
                    device=device,
                    verify=options.verify,
                )
        except TargetMissedError as error:
            missed, encoded = str(error), error.nearest
            missed += _hint(listener.plan, encoded.size)
        except KeyboardInterrupt:
            if not checkpoint.tiles or is_written_directly(target):
                raise
            done = len({version.tile for version in checkpoint.tiles})
            text = f"{done} of {listener.tiles} tiles are in {display(target)}.part"
            raise KeyboardInterrupt(f"interrupted; {text}, --resume goes on") from None
    if not files.quiet or files.as_json:
        report = Report(listener.plan, encoded, source.rounding, options.device_name)
        seconds, own = time.monotonic() - started, own_peak()
        workers = executor.peaks.bytes if isinstance(executor, ProcessExecutor) else 0
        peak = None if own is None else (own + workers) / MIB
        print_report(report, origin, target, seconds, peak, files.as_json, options.verbose)
    if missed is not None:
        raise TargetMissedError(f"{missed}; it is written to {display(target, 'stdout')}")
    if listener.ended_early and files.are_many:
        raise KeyboardInterrupt
    return encoded.size


def _hint(plan: Plan, size: int) -> str:
    """What to do about a stream that is too large, where metadata are most of it."""
    metadata, settings = plan.metadata, plan.settings
    is_quality = settings.psnr is not None or settings.ssimulacra2 is not None
    taken = 0 if metadata is None or is_quality else sum(len(blob or b"") for blob in asdict(metadata).values())
    return f", {taken:,} of them metadata, which --no-metadata leaves out" if 2 * taken > size else ""


def _executor(origin: str, options: EncodeOptions, source: Source, stack: ExitStack) -> Executor | None:
    """What works on the tiles; a cluster is open while `stack` is, and None for a single tile, which it does not take.
    Raises UsageError for what one tile cannot have.
    """
    count = options.settings.grid(source.width, source.height).count
    if count == 1 and options.resume and not options.files.are_many:
        text = "a picture in one tile keeps no checkpoint; leave --resume out"
        side = next((side for side in (1024, 512, 256) if max(source.width, source.height) > side), None)
        raise UsageError(text + (f", or cut the picture into tiles with --tile {side}" if side else ""))
    if count == 1 and options.settings.overview and not options.files.are_many:
        raise UsageError("a picture in one tile has no overview; leave --overview out")
    if options.cluster is None:
        return ProcessExecutor(options.device.cores, options.max_memory)
    if count == 1:
        return None
    from sgicodec.executors.dask import open_cluster

    if options.send_pixels or options.source_at is not None:
        return stack.enter_context(open_cluster(options.cluster, options.source_at, options.device_name))
    if origin == STANDARD or not Path(origin).is_file():
        raise UsageError(f"a cluster cannot read {display(origin)}, which is no file; add --send-pixels")
    return stack.enter_context(open_cluster(options.cluster, str(Path(origin).resolve()), options.device_name))


def _part(target: str, stack: ExitStack) -> Path:
    """Where finished tiles are kept: beside OUT, or for a moment where that is no file."""
    if not is_written_directly(target):
        return Path(os.path.realpath(target) + ".part")
    return stack.enter_context(scratch_folder()) / "part"
