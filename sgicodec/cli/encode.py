"""`sgi encode`: pictures become streams."""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.batch import Files, takes_files
from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.options import (
    BYTES,
    EFFORT,
    FILE,
    QUALITY,
    SAMPLE_RANGE,
    VERBOSE,
    alpha_option,
    batch_options,
    device_option,
    force_option,
    json_option,
    output_option,
    page_option,
    progress_option,
    quiet_option,
    target_options,
    threads_option,
)
from sgicodec.cli.paths import display, with_extension
from sgicodec.cuda.choice import check_name, device_of
from sgicodec.errors import PictureError, UsageError

if TYPE_CHECKING:
    from pathlib import Path

    from sgicodec.encoder.settings import EncodeSettings

_OF_EACH = ("sample_range", "alpha", "page", "max_memory", "resume", "verify")
"""Options beside the settings of a stream that `EncodeOptions` has as they are."""
_MAX_FILE = 1 << 20
"""Bytes that are read of networks: more than any may have."""


@click.command(
    cls=HelpfulCommand,
    short_help="Encode pictures.",
    common=("quality", "size", "psnr", "lossless", "effort", "output", "output_dir", "threads", "force", "quiet"),
    research=(
        "lmbda",
        "profile",
        "seeds",
        "per_seed",
        "texture",
        "restoration",
        "network",
        "prior",
        "features",
        "levels",
        "steps",
        "seed",
    ),
    examples=(
        ("sgi encode photo.jpg", "photo.sgi beside it"),
        ("sgi encode photo.jpg -o small.sgi --size 200kB", "a file of at most so many bytes"),
        ("sgi encode *.png --output-dir streams -q 60", "many pictures"),
    ),
)
@click.argument("paths", metavar="IN... [OUT]", nargs=-1, required=True, type=FILE)
@click.option(
    "-q",
    "--quality",
    type=QUALITY,
    metavar="1-100",
    show_default="50",
    help="Quality: 90 visually lossless, 65 web, 40 preview.",
)
@click.option("--lmbda", type=float, metavar="L", help="Squared error that a bit must save, instead of -q.")
@target_options
@click.option(
    "--max-error",
    type=click.FloatRange(0),
    metavar="N",
    help="Levels by which no sample may be off; floats by so much.",
)
@click.option("--lossless", is_flag=True, help="Every sample as it is: --max-error 0.")
@click.option("-e", "--effort", type=EFFORT, metavar="1-9", show_default="4", help="More is smaller and slower.")
@click.option("--profile", type=click.Choice(["default", "paper"]), default="default", show_default=True)
@click.option("--seeds", type=int, metavar="N", help="Number of seeds; paper profile.")
@click.option("--per-seed", type=int, metavar="K", help="Gaussians of each seed; paper profile.")
@click.option(
    "--tune",
    type=click.Choice(["visual", "psnr"]),
    help="What to optimise: the eye, or squared error.  [default: psnr with --psnr and --max-error, else visual]",
)
@click.option("--texture/--no-texture", default=True, show_default=True, help="Code texture as cosines where it pays.")
@click.option(
    "--restoration/--no-restoration",
    default=None,
    help="Let decoders restore what texture shows by a shipped network.  [default: unless --lossless]",
)
@click.option(
    "--network",
    type=click.Path(exists=True, dir_okay=False),
    metavar="FILE",
    help="A network that restores pixels instead of the shipped one; the stream takes it along.",
)
@click.option(
    "--prior",
    type=click.Path(exists=True, dir_okay=False),
    metavar="FILE",
    help="Networks of the context model instead of the shipped ones; each tile takes them along.",
)
@click.option("--features", type=int, metavar="D", help="Size of a seed's feature; paper profile.")
@click.option("--levels", type=int, metavar="M", help="Levels of the pyramid; paper profile.")
@click.option("--steps", type=int, metavar="N", help="Optimisation steps, instead of what -e says.")
@click.option(
    "--seed", type=click.IntRange(0, 2**32 - 1), default=0, metavar="N", help="Start value of the random numbers."
)
@click.option("--range", "sample_range", type=SAMPLE_RANGE, metavar="WHICH", help="Samples: used, type or LOW,HIGH.")
@alpha_option
@page_option
@click.option("--metadata/--no-metadata", default=True, show_default=True, help="Keep ICC profile, EXIF and XMP.")
@click.option("--verify/--no-verify", default=True, show_default=True, help="Decode the stream and measure it.")
@progress_option
@click.option("--tile", type=int, metavar="N", help="Side of the tiles of a large picture; 0 for a single one.")
@click.option("--overview/--no-overview", default=None, help="Add the picture in small.  [default: if it is large]")
@click.option(
    "--max-memory", type=BYTES, metavar="SIZE", help="Take fewer workers than -j, or refuse, at need: 1.5GiB."
)
@click.option("--resume", is_flag=True, help="Go on with the interrupted encode in OUT.part.")
@click.option("--cluster", metavar="ADDRESS", help="Fit tiles on a Dask cluster; local:N starts one.")
@click.option("--source-at", metavar="PLACE", help="Path or URL of IN as the cluster sees it.")
@click.option("--send-pixels", is_flag=True, help="Send pixels to the cluster, which then reads nothing.")
@output_option
@batch_options
@threads_option
@device_option
@force_option
@json_option
@quiet_option
@takes_files
def encode(
    files: Files,
    cluster: str | None,
    source_at: str | None,
    send_pixels: bool,
    threads: int,
    device: str,
    lossless: bool,
    **choices: Any,
) -> None:
    """Encode picture IN into stream OUT, by default IN's name with .sgi; - stands for stdin or stdout.

    With --output-dir or -r many IN are encoded one after the other; one that fails does not stop the others.

    A size or quality that cannot be reached ends with exit code 5 and the nearest stream in OUT.

    Ctrl-C ends the fit early and writes what it has; a second Ctrl-C writes nothing. A picture of several tiles stops
    at once: OUT.part keeps the finished ones for --resume.
    """
    check_name(device)
    computes = device_of(device if cluster is None else "cpu", threads)
    if lossless:
        if choices["max_error"] is not None:
            raise UsageError("--lossless and --max-error exclude each other")
        choices["max_error"] = 0
    for name in ("network", "prior"):
        if choices[name] is not None:
            try:
                with open(choices[name], "rb") as file:
                    choices[name] = file.read(_MAX_FILE)
            except OSError as error:
                raise UsageError(f"--{name}: {display(choices[name])}: {error.strerror or error}") from error
    of_each = {name: choices.pop(name) for name in _OF_EACH}
    settings = _settings(choices)
    if cluster is None and (source_at is not None or send_pixels):
        raise UsageError("--source-at and --send-pixels go with --cluster")
    if source_at is not None and send_pixels:
        raise UsageError("--source-at and --send-pixels exclude each other")
    if cluster is not None and of_each["max_memory"] is not None:
        raise UsageError("--max-memory is of this machine's workers, and does not go with --cluster")
    verbose = bool(click.get_current_context().meta.get(VERBOSE))

    def run(source: str, target: str | None) -> int:
        target = _default_target(source) if target is None else target
        if files.is_done(source, target):
            return 0
        started = time.monotonic()
        from sgicodec.cli.encode_file import EncodeOptions, encode_file

        where: dict[str, Any] = {"cluster": cluster, "source_at": source_at, "send_pixels": send_pixels}
        options = EncodeOptions(files, settings, computes, device, verbose, **where, **of_each)
        return encode_file(source, target, options, started)

    files.each("pictures", PictureError, _is_picture, lambda _: "sgi", "encoded", run)


def _is_picture(path: Path) -> bool:
    from sgicodec.image.reader import is_picture

    return is_picture(path)


def _default_target(source: str) -> str:
    from sgicodec.bitstream.recognition import looks_like_stream

    if os.path.isfile(source) and looks_like_stream(source):
        raise PictureError(f"{display(source)}: this is an encoded stream, not a picture; decode it first")
    if source.lower().endswith(".sgi"):
        raise UsageError(f"{display(source)} already ends in .sgi; name OUT")
    return with_extension(source, "sgi")


def _settings(choices: dict[str, Any]) -> EncodeSettings:
    """The settings that were chosen. Raises UsageError for choices that exclude each other or make no sense."""
    from sgicodec.encoder.settings import EncodeSettings, refuse_several_goals

    chosen = {name: value for name, value in choices.items() if value is not None}
    refuse_several_goals(chosen, "--")
    for name, instead in {"quality": "lmbda", "effort": "steps"}.items():
        if name in chosen and chosen["profile"] == "paper":
            raise UsageError(f"--{name} is a scale of the default profile; give --{instead} to the paper profile")
    return EncodeSettings(**chosen)
