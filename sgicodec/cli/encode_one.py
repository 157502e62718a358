"""`sgi encode` of a picture in one tile, which is fitted whole."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from sgicodec.cli.interrupt import EarlyEnd
from sgicodec.cli.paths import display, write_output
from sgicodec.cli.progress import Mode, fit_progress
from sgicodec.errors import StreamError, TargetMissedError

if TYPE_CHECKING:
    from sgicodec.cli.encode_job import Job
    from sgicodec.encoder.tile_encoder import Encoded
    from sgicodec.fit.trainer import Progress
    from sgicodec.picture import Picture

__all__ = ["encode_one"]


def encode_one(job: Job, origin: Path | BinaryIO) -> int:
    """Fits the picture, writes the stream and prints the report; returns the stream's bytes.

    Raises TargetMissedError, after all of that, for a goal that was missed.
    """
    from sgicodec.cli.report import Report, print_report
    from sgicodec.image import read

    picture = read(origin, sample_range=job.float_range)
    with EarlyEnd() as early:
        progress: Mode = "off" if job.quiet else job.progress
        encoded, last, missed = _fit(picture, job, progress, early, job.quiet)
        report = Report.of(picture, encoded, job.settings, last, job.verify, job.device)
        write_output(job.target, encoded.data, StreamError)
    if not job.quiet or job.as_json:
        print_report(report, job.source, job.target, time.monotonic() - job.started, job.as_json, job.verbose)
    if missed is not None:
        raise TargetMissedError(f"{missed}; it is written to {display(job.target, 'stdout')}")
    if early.asked and job.batch:
        raise KeyboardInterrupt
    return len(encoded.data)


def _fit(
    picture: Picture, job: Job, progress: Mode, early: EarlyEnd, quiet: bool
) -> tuple[Encoded, Progress, TargetMissedError | None]:
    """The stream, the state of its fit after the last step, and what was asked for and not reached."""
    from sgicodec.encoder.pipeline import encode as encode_picture

    states: list[Progress] = []
    with fit_progress(progress, picture.width * picture.height) as draw:

        def on_progress(state: Progress) -> bool:
            states[:] = [state]
            early.arm()
            draw(state)
            if early.asked and not quiet:
                click.echo(f"sgi: interrupted at step {state.step} of {state.steps}; writing what is there", err=True)
            return not early.asked

        try:
            return encode_picture(picture, job.settings, on_progress, job.started, job.device), _last(states), None
        except TargetMissedError as missed:
            return missed.nearest, _last(states), missed


def _last(states: list[Progress]) -> Progress:
    """The fit's last state; one of no steps where no pixel held anything."""
    from sgicodec.fit.trainer import Progress

    return states[0] if states else Progress(0, 0, 0, float("inf"), 0.0, 0.0)
