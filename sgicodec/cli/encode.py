"""`sgi encode`: a picture becomes a stream."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.interrupt import EarlyEnd
from sgicodec.cli.options import BYTES, FLOAT_RANGE, VERBOSE, force_option, json_option, threads_option
from sgicodec.cli.paths import STANDARD, check_output, display, picture_source, with_extension, write_output
from sgicodec.cli.progress import Mode, fit_progress
from sgicodec.errors import StreamError, TargetMissedError, UsageError

if TYPE_CHECKING:
    from sgicodec.encoder import Encoded, EncodeSettings
    from sgicodec.fit.trainer import Progress
    from sgicodec.image import Picture

__all__ = ["encode"]


@click.command(short_help="Encode a picture.")
@click.argument("source", metavar="IN")
@click.argument("target", metavar="[OUT]", required=False)
@click.option("-q", "--quality", type=float, metavar="1-100", show_default="50", help="Quality; more is better.")
@click.option("--lmbda", type=float, metavar="L", help="Squared error that a bit must save, instead of -q.")
@click.option("--psnr", type=float, metavar="DB", help="PSNR to end at, instead of -q.")
@click.option("--bpp", type=float, metavar="X", help="Bits per pixel to end at, never above.")
@click.option("--size", type=BYTES, metavar="BYTES", help="File size to end at, never above: 20000, 200kB, 1.5MiB.")
@click.option("-e", "--effort", type=int, metavar="1-9", show_default="5", help="More is smaller and slower.")
@click.option("--profile", type=click.Choice(["default", "paper"]), default="default", show_default=True)
@click.option("--seeds", type=int, metavar="N", help="Number of seeds; paper profile.")
@click.option("--per-seed", type=int, metavar="K", help="Gaussians of each seed.")
@click.option("--features", type=int, metavar="D", help="Size of a seed's feature; paper profile.")
@click.option("--levels", type=int, metavar="M", help="Levels of the pyramid; paper profile.")
@click.option("--steps", type=int, metavar="N", help="Optimisation steps, instead of what -e says.")
@click.option("--time-limit", type=float, metavar="S", help="Seconds to spend, instead of -e.")
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=0, metavar="N", help="Of the random numbers.")
@click.option("--float-range", type=FLOAT_RANGE, metavar="LOW,HIGH", help="Samples of float input to cover.")
@click.option("--metadata/--no-metadata", default=True, show_default=True, help="Keep ICC profile, EXIF and XMP.")
@click.option("--verify/--no-verify", default=True, show_default=True, help="Decode the stream and measure it.")
@click.option("--progress", type=click.Choice(["auto", "on", "off"]), default="auto", show_default=True)
@threads_option
@force_option
@json_option
@click.option("--quiet", is_flag=True, help="Print errors only.")
def encode(
    source: str,
    target: str | None,
    float_range: tuple[float, float] | None,
    verify: bool,
    progress: Mode,
    force: bool,
    as_json: bool,
    quiet: bool,
    **choices: Any,
) -> None:
    """Encode picture IN into stream OUT, by default IN's name with .sgi; - stands for stdin or stdout.

    A size or quality that cannot be reached ends with exit code 5 and the nearest stream in OUT.

    Ctrl-C ends the fit early and writes what it has; a second Ctrl-C writes nothing.
    """
    from sgicodec.cli.report import Report, print_report
    from sgicodec.image import read

    started = time.monotonic()
    target = _default_target(source) if target is None else target
    if as_json and target == STANDARD:
        raise UsageError("stdout cannot take both the stream and --json; name OUT")
    check_output(target, source, force)
    settings = _settings(choices)
    picture = read(picture_source(source), sample_range=float_range)
    with EarlyEnd() as early:
        encoded, last, missed = _fit(picture, settings, started, "off" if quiet else progress, early, quiet)
        report = Report.of(picture, encoded, settings, last, verify)
        write_output(target, encoded.data, StreamError)
    if not quiet or as_json:
        verbose = bool(click.get_current_context().meta.get(VERBOSE))
        print_report(report, source, target, time.monotonic() - started, as_json, verbose)
    if missed is not None:
        raise TargetMissedError(f"{missed}; it is written to {display(target, 'stdout')}")


def _default_target(source: str) -> str:
    if source.lower().endswith(".sgi"):
        raise UsageError(f"{display(source)} already ends in .sgi; name OUT")
    return with_extension(source, "sgi")


def _settings(choices: dict[str, Any]) -> EncodeSettings:
    """The settings that were chosen. Raises UsageError for choices that exclude each other or make no sense."""
    from sgicodec.encoder import EncodeSettings

    chosen = {name: value for name, value in choices.items() if value is not None}
    for names in (("quality", "lmbda", "psnr", "bpp", "size"), ("effort", "time_limit"), ("steps", "time_limit")):
        given = [f"--{name.replace('_', '-')}" for name in names if name in chosen]
        if len(given) > 1:
            raise UsageError(f"{given[0]} and {given[1]} exclude each other")
    if chosen["profile"] == "paper":
        for name, instead in (("quality", "lmbda"), ("effort", "steps")):
            if name in chosen:
                raise UsageError(f"--{name} is a scale of the default profile; give --{instead} to the paper profile")
    return EncodeSettings(**chosen)


def _fit(
    picture: Picture, settings: EncodeSettings, started: float, progress: Mode, early: EarlyEnd, quiet: bool
) -> tuple[Encoded, Progress, TargetMissedError | None]:
    """The stream, the state of its fit after the last step, and what was asked for and not reached."""
    from sgicodec.encoder import encode as encode_picture

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
            return encode_picture(picture, settings, on_progress, started), states[0], None
        except TargetMissedError as missed:
            return missed.nearest, states[0], missed
