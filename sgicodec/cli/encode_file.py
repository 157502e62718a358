"""One picture of `sgi encode`: opened, encoded by one call of the library, reported."""

from __future__ import annotations

import os
import sys
import time
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Literal

from sgicodec.cli.associated import associated_pictures, write_associated
from sgicodec.cli.encode_listener import EncodeListener
from sgicodec.cli.paths import STANDARD, check_output, display, local_name
from sgicodec.cli.progress import Mode
from sgicodec.cli.report import Report, print_report
from sgicodec.cuda.choice import device_of
from sgicodec.encoder.checkpoint import Checkpoint
from sgicodec.errors import EncodeInterruptedError, StreamError, TargetMissedError, UsageError
from sgicodec.executors.executor import MIB
from sgicodec.executors.gpus import GpuExecutor
from sgicodec.executors.peak import own_peak
from sgicodec.executors.processes import ProcessExecutor
from sgicodec.executors.threads import ThreadExecutor
from sgicodec.image.source import open_to_encode
from sgicodec.remote.upload import Upload
from sgicodec.remote.url import is_url

if TYPE_CHECKING:
    from sgicodec.device import Device
    from sgicodec.encoder.encoded import Encoded
    from sgicodec.encoder.settings import EncodeSettings
    from sgicodec.executors.executor import Executor
    from sgicodec.image import Alpha, Source
    from sgicodec.image.used_range import RangeChoice

__all__ = ["Job", "encode_file"]


@dataclass(frozen=True)
class Job:
    """What the options say of one picture. target: a path, a URL, or - for stdout; started: a value of
    time.monotonic(); device: without a cluster; device_name: what was asked for, which workers of a cluster find;
    named: whether target was named with -o; by_default: whether nobody named it.
    """

    source: str
    target: str
    settings: EncodeSettings
    device: Device
    started: float
    sample_range: RangeChoice | None
    verify: bool
    progress: Mode
    force: bool
    as_json: bool
    quiet: bool
    verbose: bool
    resume: bool
    max_memory: float | None
    cluster: str | None
    device_name: str
    source_at: str | None
    send_pixels: bool
    alpha: Alpha
    page: int | None
    batch: bool
    named: bool
    by_default: bool
    associated: bool


def encode_file(job: Job) -> int:
    """Encodes one picture and prints the report; returns the stream's bytes.

    Raises TargetMissedError, after all of that, for a goal that was missed.
    """
    if job.as_json and job.target == STANDARD:
        raise UsageError("stdout cannot take both the stream and --json; name OUT")
    becomes: Literal["stream"] | None = None if job.named else "stream"
    check_output(job.target, job.source, job.force, by_default=job.by_default, becomes=becomes)
    pictures = associated_pictures(job.source, job.target, job.force, job.by_default) if job.associated else []
    origin = sys.stdin.buffer.read() if job.source == STANDARD else job.source
    missed = None
    with ExitStack() as stack:
        listener = EncodeListener("off" if job.quiet else job.progress, job.quiet, job.cluster is not None, job.source)
        samples: dict[str, Any] = {"sample_range": job.sample_range, "alpha": job.alpha, "page": job.page}
        source = stack.enter_context(open_to_encode(origin, listener.note, **samples, option="--page"))
        executor = _executor(job, source, stack)
        checkpoint = Checkpoint(_part(job, stack), job.resume, job.force)
        upload = stack.enter_context(Upload(job.target, StreamError)) if is_url(job.target) else None
        try:
            with listener:
                encoded = _encode(job, source, executor, checkpoint, listener, None if upload is None else upload.path)
        except TargetMissedError as error:
            missed, encoded = str(error), error.nearest
        except KeyboardInterrupt:
            if not checkpoint.is_open or job.target == STANDARD:
                raise
            done = len({version.tile for version in checkpoint.tiles})
            text = f"{done} of {listener.tiles} tiles are in {display(local_name(job.target))}.part"
            raise EncodeInterruptedError(f"interrupted; {text}, --resume goes on") from None
        if upload is not None:
            upload.send()
    if job.associated:
        write_associated(pictures, job.source, tells=not (job.quiet or job.as_json))
    if not job.quiet or job.as_json:
        report = Report.of(listener.plan, encoded, job.device_name)
        seconds, own = time.monotonic() - job.started, own_peak()
        workers = executor.peaks.bytes if isinstance(executor, ProcessExecutor | GpuExecutor) else 0
        peak = None if own is None else (own + workers) / MIB
        print_report(report, job.source, job.target, seconds, peak, job.as_json, job.verbose)
    if missed is not None:
        raise TargetMissedError(f"{missed}; it is written to {display(job.target, 'stdout')}")
    if listener.ended_early and job.batch:
        raise KeyboardInterrupt
    return encoded.size


def _encode(
    job: Job,
    source: Source,
    executor: Executor | None,
    checkpoint: Checkpoint,
    listener: EncodeListener,
    instead: Path | None,
) -> Encoded:
    """instead: where the stream is written before it is sent to a URL."""
    from sgicodec.encoder.pipeline import encode_picture

    output: Path | BinaryIO = instead or (sys.stdout.buffer if job.target == STANDARD else Path(job.target))
    device = device_of(job.device_name, job.device.threads) if executor is None else job.device
    try:
        return encode_picture(
            source,
            job.settings,
            output=output,
            executor=executor,
            store=checkpoint,
            progress=listener,
            device=device,
            verify=job.verify,
            started=job.started,
        )
    except BrokenPipeError:
        raise
    except OSError as error:
        raise StreamError(f"{display(job.target, 'stdout')}: {error.strerror or error}") from error


def _executor(job: Job, source: Source, stack: ExitStack) -> Executor | None:
    """What works on the tiles; a cluster is open while `stack` is, and None for a single tile, which it does not take.
    Raises UsageError for what one tile cannot have.
    """
    count = job.settings.grid(source.width, source.height).count
    if count == 1 and job.resume and not job.batch:
        text = "a picture in one tile keeps no checkpoint; leave --resume out"
        side = next((side for side in (1024, 512, 256) if max(source.width, source.height) > side), None)
        raise UsageError(text + (f", or cut the picture into tiles with --tile {side}" if side else ""))
    if job.cluster is None:
        return _local_executor(job.device, job.max_memory)
    if count == 1:
        return None
    from sgicodec.executors.dask import open_cluster

    if job.send_pixels or job.source_at is not None:
        return stack.enter_context(open_cluster(job.cluster, job.source_at, job.device_name))
    if job.source == STANDARD or not Path(job.source).is_file():
        raise UsageError(f"a cluster cannot read {display(job.source)}, which is no file; add --send-pixels")
    return stack.enter_context(open_cluster(job.cluster, str(Path(job.source).resolve()), job.device_name))


def _local_executor(device: Device, max_memory: float | None) -> Executor:
    """Processes for the processor; threads for a GPU, which one process feeds best; for several, a process for each."""
    if device.gpu is None:
        return ProcessExecutor(device.cores, max_memory)
    if device.gpus == 1:
        return ThreadExecutor(device.cores + 1, max_memory)
    return GpuExecutor(device.gpus, device.cores + device.gpus, max_memory, device.gpu)


def _part(job: Job, stack: ExitStack) -> Path:
    """Where finished tiles are kept: beside OUT, of a URL in the working folder, or for a moment where there is no
    OUT.
    """
    if job.target != STANDARD:
        return Path(os.path.realpath(local_name(job.target)) + ".part")
    import tempfile

    return Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="sgicodec-"))) / "part"
