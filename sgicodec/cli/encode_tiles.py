"""`sgi encode` of a picture in several tiles, which is read window by window."""

from __future__ import annotations

import os
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sgicodec.cli.paths import STANDARD, display
from sgicodec.cli.progress import tile_progress
from sgicodec.errors import EncodeInterruptedError, StreamError, TargetMissedError, UsageError

if TYPE_CHECKING:
    from sgicodec.cli.encode_job import Job
    from sgicodec.encoder.checkpoint import Journal
    from sgicodec.encoder.interfaces import Runner
    from sgicodec.encoder.out_of_core import Totals
    from sgicodec.encoder.plan import Plan
    from sgicodec.encoder.time_budget import TimeShares
    from sgicodec.image import Source

__all__ = ["encode_tiles"]


def encode_tiles(job: Job, source: Source) -> int:
    """Fits what OUT.part lacks, writes the stream and prints the report; returns the stream's bytes.

    Raises TargetMissedError, after all of that, for a goal that was missed.
    """
    from sgicodec.cli.report import Report, print_report
    from sgicodec.encoder.checkpoint import fingerprint, opened_journal
    from sgicodec.encoder.out_of_core import plan_of

    plan = plan_of(source, job.settings)
    with ExitStack() as stack:
        on_cluster = job.cluster is not None
        runner, workers = _cluster(job, source, plan, stack) if on_cluster else _runner(job, source, plan)
        if job.target == STANDARD:
            part = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="sgicodec-"))) / "part"
        else:
            part = Path(os.path.realpath(job.target) + ".part")
        mark = fingerprint(plan, None if job.source == STANDARD else Path(job.source))
        try:
            journal = stack.enter_context(opened_journal(part, mark, job.resume, job.force))
            totals = _run(job, source, plan, runner, journal, _shares(job, source, plan, workers))
        except OSError as error:
            raise StreamError(f"{display(job.target, 'stdout')}: {error.strerror or error}") from error
    psnr = _psnr(job, source) if job.verify and job.target != STANDARD else None
    report = Report.of_tiles(plan, totals, psnr)
    if not job.quiet or job.as_json:
        print_report(report, job.source, job.target, time.monotonic() - job.started, job.as_json, job.verbose)
    if totals.missed is not None:
        raise TargetMissedError(f"{totals.missed}; it is written to {display(job.target, 'stdout')}")
    return totals.bytes


def _shares(job: Job, source: Source, plan: Plan, workers: int) -> TimeShares | None:
    """Who tells each tile its time, where that is the limit."""
    from sgicodec.encoder.out_of_core import time_shares

    if job.settings.time_limit is None:
        return None
    verified = job.verify and job.target != STANDARD
    return time_shares(
        source, plan, job.started + job.settings.time_limit, workers, job.device.cores if verified else 0
    )


def _runner(job: Job, source: Source, plan: Plan) -> tuple[Runner, int]:
    """Who fits the tiles, and how many at once. Tells what memory that will take."""
    from sgicodec.encoder.memory import MIB, estimate, fitting_workers
    from sgicodec.encoder.out_of_core import run_tiles

    grid = plan.header.grid
    _, _, width, height = grid.rect(0)
    found = estimate(plan, source.memory(width, height))
    workers = fitting_workers(found, min(job.device.cores, grid.count), job.max_memory)
    if not job.quiet:
        text = f"{grid.count} tiles of {width}×{height} pixels, {workers} worker{'s' * (workers > 1)}"
        click.echo(f"{text}, about {found.total(workers) / MIB:,.0f} MiB of memory", err=True)
    return run_tiles(source, plan, workers, job.device), workers


def _cluster(job: Job, source: Source, plan: Plan, stack: ExitStack) -> tuple[Runner, int]:
    """The same for a cluster, which is open while `stack` is."""
    from sgicodec.encoder.memory import MIB, estimate
    from sgicodec.encoder.out_of_core import run_on_cluster
    from sgicodec.executors.dask import open_cluster

    cluster = stack.enter_context(open_cluster(job.cluster or ""))
    place = job.source_at
    if place is None and not job.send_pixels:
        if job.source == STANDARD:
            raise UsageError("a cluster cannot read stdin; add --send-pixels")
        place = str(Path(job.source).resolve())
    if not job.quiet:
        grid = plan.header.grid
        _, _, width, height = grid.rect(0)
        worker = estimate(plan, source.memory(width, height)).worker / MIB
        text = f"{grid.count} tiles of {width}×{height} pixels, {cluster.workers} at once on the cluster"
        click.echo(f"{text}, each about {worker:,.0f} MiB of memory", err=True)
    return run_on_cluster(
        source, plan, cluster, place, job.device.with_threads(max(1, job.device.threads))
    ), cluster.workers


def _run(job: Job, source: Source, plan: Plan, runner: Runner, journal: Journal, shares: TimeShares | None) -> Totals:
    from sgicodec.encoder.out_of_core import encode_source

    target = sys.stdout.buffer if job.target == STANDARD else Path(job.target)
    try:
        with tile_progress("off" if job.quiet else job.progress) as draw:
            return encode_source(source, plan, runner, journal, target, draw, shares, job.device)
    except KeyboardInterrupt:
        if job.target == STANDARD:
            raise
        done = len({version.tile for version in journal.tiles})
        text = f"{done} of {plan.header.grid.count} tiles are in {display(job.target)}.part"
        raise EncodeInterruptedError(f"interrupted; {text}, --resume goes on") from None


def _psnr(job: Job, source: Source) -> float:
    from sgicodec.decoder.stream import open_stream
    from sgicodec.encoder.measure import measured_psnr

    with open_stream(Path(job.target), job.device) as stream:
        return measured_psnr(stream, source)
