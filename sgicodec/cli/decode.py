"""`sgi decode`: a stream, or a part of it at any scale, becomes a picture."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sgicodec.cli.options import REGION, SCALE, SIZE, VERBOSE, force_option, threads_option
from sgicodec.cli.paths import STANDARD, check_output, display, opened_stream, with_extension, write_output
from sgicodec.errors import PictureError, UsageError

if TYPE_CHECKING:
    from sgicodec.bitstream.header import Header
    from sgicodec.decoder import Region
    from sgicodec.image import Picture

__all__ = ["decode"]


@click.command(short_help="Decode a stream, or a part of it, at any scale.")
@click.argument("source", metavar="IN")
@click.argument("target", metavar="[OUT]", required=False)
@click.option("--region", type=REGION, metavar="X,Y,W,H", help="Only these pixels of the picture.")
@click.option("--scale", type=SCALE, metavar="F", help="Enlarge or shrink by this factor, such as 2 or 1/4.")
@click.option("--size", type=SIZE, metavar="WxH", help="Scale to this size; 512x and x512 keep the aspect.")
@click.option("--depth", type=click.Choice(["8", "16", "32"]), help="Bits per sample.  [default: the source's]")
@click.option("--format", "format_", metavar="NAME", help="Picture format.  [default: by OUT's extension]")
@click.option(
    "--png-level",
    type=click.IntRange(0, 9),
    metavar="0-9",
    show_default="2",
    help="How hard PNG is compressed.",
)
@threads_option
@force_option
def decode(
    source: str,
    target: str | None,
    region: Region | None,
    scale: float | None,
    size: tuple[int | None, int | None] | None,
    depth: str | None,
    format_: str | None,
    png_level: int | None,
    threads: int,
    force: bool,
) -> None:
    """Decode stream IN into picture OUT; - stands for stdin or stdout.

    OUT is by default IN's name with .png, or .tif for what PNG cannot hold: floats, or bands without a meaning.
    """
    if scale is not None and size is not None:
        raise UsageError("--scale and --size exclude each other")
    bits = None if depth is None else int(depth)
    with opened_stream(source) as stream:
        extension = _extension(stream.header, target, format_, bits)
        target = with_extension(source, extension) if target is None else target
        check_output(target, source, force)
        _, _, width, height = region or (0, 0, stream.width, stream.height)
        picture = stream.picture(region, scale, None if size is None else _whole(size, width, height), threads)
    _write(picture, target, extension, bits, png_level, threads)
    if click.get_current_context().meta.get(VERBOSE):
        name = display(target, "stdout")
        click.echo(f"{name}: {picture.width}×{picture.height}, {picture.channels}", err=True)


def _extension(header: Header, target: str | None, format_: str | None, bits: int | None) -> str:
    """Extension of the format to write. Raises UsageError for an unknown format."""
    from sgicodec.image.formats import find

    if format_ is None and (target is None or target == STANDARD):
        is_float = bits == 32 or (bits is None and header.sample_type == "float32")
        return "tif" if is_float or header.channels == "multi" else "png"
    suffix = "" if target is None else Path(target).suffix.removeprefix(".")
    if format_ is None and not suffix:
        raise UsageError(f"{display(target or '')} has no extension that names a format; add one or give --format")
    if format_ is None and suffix.lower() == "sgi":
        raise UsageError("a decoded picture ending in .sgi is a Silicon Graphics one; if you mean it, add --format sgi")
    try:
        return find(format_ or suffix).extensions[0]
    except PictureError as error:
        raise UsageError(str(error)) from None


def _whole(size: tuple[int | None, int | None], width: int, height: int) -> tuple[int, int]:
    """The size in pixels, a missing side by the aspect of `width` × `height`."""
    wide, high = size
    if wide is None:
        wide = max(1, round(width * (high or 1) / height))
    if high is None:
        high = max(1, round(height * wide / width))
    return wide, high


def _write(
    picture: Picture, target: str, extension: str, bits: int | None, png_level: int | None, threads: int
) -> None:
    from sgicodec.image import write

    if target != STANDARD:
        write(picture, target, format=extension, depth=bits, png_level=png_level, threads=threads)
        return
    buffer = io.BytesIO()
    write(picture, buffer, format=extension, depth=bits, png_level=png_level, threads=threads)
    write_output(target, buffer.getvalue(), PictureError)
