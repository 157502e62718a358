"""`sgi decode`: streams, or parts of them at any scale, become pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from sgicodec.cli.batch import Files, takes_files
from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.decode_file import DecodeJob
from sgicodec.cli.limits import DecodeLimits
from sgicodec.cli.options import (
    BYTES,
    FILE,
    REGION,
    SCALE,
    SIZE,
    Sized,
    batch_options,
    force_option,
    json_option,
    output_option,
    progress_option,
    quiet_option,
    threads_option,
)
from sgicodec.cli.paths import is_stream
from sgicodec.cli.pictures import Output
from sgicodec.cli.views import ViewOptions
from sgicodec.device import Device
from sgicodec.errors import StreamError, UsageError
from sgicodec.plugins.compression import Compression

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Region


@click.command(
    cls=HelpfulCommand,
    short_help="Decode streams, or a part of them, at any scale.",
    common=("region", "scale", "size", "depth", "format_", "output", "output_dir", "threads", "force", "quiet"),
    examples=(
        ("sgi decode photo.sgi", "photo.png beside it"),
        ("sgi decode photo.sgi part.png --region 100,50,256,256 --scale 4", "a detail, enlarged"),
        ("sgi decode photo.sgi small.jpg --size 512x512", "the picture, fitted into a square"),
    ),
)
@click.argument("paths", metavar="IN... [OUT]", nargs=-1, required=True, type=FILE)
@click.option("--region", type=REGION, metavar="X,Y,W,H", help="Only these pixels, cut where the picture ends.")
@click.option("--scale", type=SCALE, metavar="F", help="Enlarge or shrink by this factor, such as 2 or 1/4.")
@click.option("--size", type=SIZE, metavar="WxH", help="Scale to fit into this size; 512x, x512; 512x512! is exact.")
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
@click.option("--pyramid", is_flag=True, help="Tiled TIFF with reductions; OUT.ome.tif is one as OME-TIFF.")
@click.option("--cog", is_flag=True, help="Cloud Optimized GeoTIFF.")
@click.option(
    "--compress",
    metavar="NAME[:N]",
    show_default="deflate",
    help="How pyramids are compressed: deflate, zstd, jpeg:QUALITY, webp:QUALITY, lerc:ERROR.",
)
@click.option("--max-pixels", type=click.IntRange(1), metavar="N", help="Refuse to write more pixels.")
@click.option("--max-memory", type=BYTES, metavar="SIZE", help="Refuse what takes more memory to decode: 500MiB.")
@click.option(
    "--dither/--no-dither",
    default=True,
    show_default=True,
    help="Dither 8 bits of what had more, so that skies show no contours.",
)
@click.option(
    "--metadata/--no-metadata", default=True, show_default=True, help="Keep ICC profile, EXIF, XMP and place on earth."
)
@click.option("--exact", is_flag=True, help="Draw small views of large pictures from all that the stream holds.")
@click.option("--lossy", is_flag=True, help="Leave a residual layer aside: faster.")
@output_option
@batch_options
@threads_option
@force_option
@progress_option
@json_option
@quiet_option
@takes_files
def decode(
    files: Files,
    region: Region | None,
    scale: float | None,
    size: Sized | None,
    boundless: bool,
    depth: str | None,
    format_: str | None,
    png_level: int | None,
    pyramid: bool,
    cog: bool,
    compress: str | None,
    max_pixels: int | None,
    max_memory: float | None,
    dither: bool,
    metadata: bool,
    exact: bool,
    lossy: bool,
    threads: int,
) -> None:
    """Decode stream IN into picture OUT; - stands for stdin or stdout.

    OUT is by default IN's name with .png, or .tif for what PNG cannot hold: floats, bands without a meaning, a place
    on the map.

    With --output-dir or -r many IN are decoded one after the other; one that fails does not stop the others.
    """
    view = ViewOptions(region, scale, size, boundless, files.quiet)
    bits = None if depth is None else int(depth)
    if pyramid and cog:
        raise UsageError("--pyramid and --cog exclude each other")
    compression = None if compress is None else Compression.parse(compress)
    job = DecodeJob(
        files,
        view,
        DecodeLimits.of(max_pixels, max_memory),
        Output(bits, png_level, threads, "cog" if cog else "tiff" if pyramid else None, compression),
        Device(threads),
        format_,
        metadata,
        exact,
        dither,
        lossy,
    )
    files.each("streams", StreamError, is_stream, job.extension_of, "decoded", job.run)
