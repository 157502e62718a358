"""`sgi decode`: a stream, or a part of it at any scale, becomes a picture."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sgicodec.cli.batch import named_targets, run_batch
from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.options import (
    REGION,
    SCALE,
    SIZE,
    VERBOSE,
    Sized,
    complete_files,
    force_option,
    output_option,
    threads_option,
)
from sgicodec.cli.paths import STANDARD, check_output, display, opened_stream, with_extension
from sgicodec.cli.pictures import Output, write_bands, write_picture
from sgicodec.cli.place import lost_outside_tiff
from sgicodec.cli.views import ViewOptions
from sgicodec.device import Device
from sgicodec.errors import PictureError, UsageError

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Bands, Region, Stream
    from sgicodec.picture import Picture

__all__ = ["decode"]

_DTYPES = {None: None, 8: "uint8", 16: "uint16", 32: "float32"}
"""Samples of so many bits, which are rendered as such."""


@click.command(
    cls=HelpfulCommand,
    short_help="Decode streams, or a part of them, at any scale.",
    common=("region", "scale", "size", "depth", "format_", "output", "output_dir", "threads", "force"),
    examples=(
        ("sgi decode photo.sgi", "photo.png beside it"),
        ("sgi decode photo.sgi part.png --region 100,50,256,256 --scale 4", "a detail, enlarged"),
        ("sgi decode photo.sgi small.jpg --size 512x512", "the picture, fitted into a square"),
    ),
)
@click.argument("paths", metavar="IN... [OUT]", nargs=-1, required=True, shell_complete=complete_files)
@click.option("--region", type=REGION, metavar="X,Y,W,H", help="Only these pixels, cut where the picture ends.")
@click.option("--scale", type=SCALE, metavar="F", help="Enlarge or shrink by this factor, such as 2 or 1/4.")
@click.option("--size", type=SIZE, metavar="WxH", help="Scale to fit into this size; 512x, x512; 512x512! is exact.")
@click.option("--exact-size", is_flag=True, help="Scale to exactly --size, whatever the aspect.")
@click.option("--boundless", is_flag=True, help="Pad a --region that reaches over the picture; nodata, else 0.")
@click.option("--depth", type=click.Choice(["8", "16", "32"]), help="Bits per sample.  [default: the source's]")
@click.option("--format", "format_", metavar="NAME", help="Picture format.  [default: by OUT's extension]")
@click.option(
    "--png-level",
    type=click.IntRange(0, 9),
    metavar="0-9",
    show_default="2",
    help="How hard PNG is compressed.",
)
@click.option("--exact", is_flag=True, help="Draw small views of large pictures from all that the stream holds.")
@output_option
@click.option("--output-dir", metavar="DIR", help="Decode all IN into this folder.")
@threads_option
@force_option
def decode(
    paths: tuple[str, ...],
    region: Region | None,
    scale: float | None,
    size: Sized | None,
    exact_size: bool,
    boundless: bool,
    depth: str | None,
    format_: str | None,
    png_level: int | None,
    exact: bool,
    output: str | None,
    output_dir: str | None,
    threads: int,
    force: bool,
) -> None:
    """Decode stream IN into picture OUT; - stands for stdin or stdout.

    OUT is by default IN's name with .png, or .tif for what PNG cannot hold: floats, bands without a meaning, a place
    on the map.

    With --output-dir many IN are decoded one after the other; one that fails does not stop the others.
    """
    view = ViewOptions(region, scale, size, exact_size, boundless, quiet=False)
    bits = None if depth is None else int(depth)
    verbose = bool(click.get_current_context().meta.get(VERBOSE))
    job = _Job(view, Output(bits, png_level, threads), format_, exact, force, verbose)
    if output is not None and (output_dir is not None or len(paths) > 1):
        raise UsageError("-o names the OUT of one IN; it does not go with another name or --output-dir")
    if output_dir is not None:
        targets = named_targets(paths, output_dir, partial(_extension_of, job))
        run_batch("decoded", targets, partial(_decode, job))
    elif len(paths) > 2:
        raise click.UsageError(f"{len(paths)} names; give IN and OUT, or --output-dir for many streams")
    else:
        _decode(job, paths[0], output or (paths[1] if len(paths) == 2 else None))


@dataclass(frozen=True)
class _Job:
    """What the options say."""

    view: ViewOptions
    output: Output
    format_: str | None
    exact: bool
    force: bool
    verbose: bool


def _extension_of(job: _Job, source: str) -> str:
    with opened_stream(source) as stream:
        return _extension(stream, None, job.format_, job.output.bits)


def _decode(job: _Job, source: str, target: str | None) -> int:
    """Decodes one stream; returns the bytes of the picture, 0 if it went to stdout."""
    with opened_stream(source, Device(job.output.threads)) as stream:
        extension = _extension(stream, target, job.format_, job.output.bits)
        target = with_extension(source, extension) if target is None else target
        check_output(target, source, job.force)
        lost = "" if extension == "tif" else lost_outside_tiff(stream.metadata.geo)
        stream.exact = job.exact
        view = job.view.of(stream) | {"dtype": _DTYPES[job.output.bits]}
        shown: Bands | Picture
        if stream.grid.count > 1:
            shown = stream.bands(**view)
            write_bands(stream.header, shown, target, extension, job.output)
        else:
            shown = picture = stream.picture(**view)
    if stream.grid.count == 1:
        write_picture(picture, target, extension, job.output)
    if lost:
        click.echo(f"sgi: {display(target, 'stdout')}: .{extension} does not hold its {lost}; .tif does", err=True)
    if job.verbose:
        text = f"{shown.width}×{shown.height}, {stream.header.channels}"
        click.echo(f"{display(target, 'stdout')}: {text}", err=True)
    return 0 if target == STANDARD else Path(target).stat().st_size


def _extension(stream: Stream, target: str | None, format_: str | None, bits: int | None) -> str:
    """Extension of the format to write. Raises UsageError for an unknown format."""
    from sgicodec.image.formats import find

    if format_ is None and (target is None or target == STANDARD):
        header = stream.header
        is_float = bits == 32 or (bits is None and header.sample_type == "float32")
        return "tif" if is_float or header.channels == "multi" or lost_outside_tiff(stream.metadata.geo) else "png"
    suffix = "" if target is None else Path(target).suffix.removeprefix(".")
    if format_ is None and not suffix:
        raise UsageError(f"{display(target or '')} has no extension that names a format; add one or give --format")
    if format_ is None and suffix.lower() == "sgi":
        raise UsageError("a decoded picture ending in .sgi is a Silicon Graphics one; if you mean it, add --format sgi")
    try:
        return find(format_ or suffix).extensions[0]
    except PictureError as error:
        raise UsageError(str(error)) from None
