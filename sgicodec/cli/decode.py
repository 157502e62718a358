"""`sgi decode`: streams, or parts of them at any scale, become pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from sgicodec.cli.batch import Batch, batch_items
from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.decode_file import DecodeJob
from sgicodec.cli.limits import DecodeLimits
from sgicodec.cli.options import (
    BYTES,
    REGION,
    SCALE,
    SIZE,
    Sized,
    batch_options,
    complete_files,
    force_option,
    json_option,
    output_option,
    progress_option,
    quiet_option,
    threads_option,
)
from sgicodec.cli.paths import is_stream, refuse_folder
from sgicodec.cli.pictures import Output
from sgicodec.cli.views import ViewOptions
from sgicodec.device import Device
from sgicodec.errors import StreamError, UsageError
from sgicodec.plugins.compression import Compression

if TYPE_CHECKING:
    from sgicodec.cli.progress import Mode
    from sgicodec.decoder.stream import Region

__all__ = ["decode"]


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
@click.argument("paths", metavar="IN... [OUT]", nargs=-1, required=True, shell_complete=complete_files)
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
def decode(
    paths: tuple[str, ...],
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
    output: str | None,
    output_dir: str | None,
    recursive: bool,
    skip_existing: bool,
    threads: int,
    force: bool,
    progress: Mode,
    as_json: bool,
    quiet: bool,
) -> None:
    """Decode stream IN into picture OUT; - stands for stdin or stdout.

    OUT is by default IN's name with .png, or .tif for what PNG cannot hold: floats, bands without a meaning, a place
    on the map.

    With --output-dir or -r many IN are decoded one after the other; one that fails does not stop the others.
    """
    view = ViewOptions(region, scale, size, boundless, quiet)
    bits = None if depth is None else int(depth)
    if pyramid and cog:
        raise UsageError("--pyramid and --cog exclude each other")
    compression = None if compress is None else Compression.parse(compress)
    many = output_dir is not None or recursive
    by_default = output_dir is None and output is None and (recursive or len(paths) == 1)
    how = (output is not None, by_default, as_json, quiet, "off" if many else progress)
    job = DecodeJob(
        view,
        DecodeLimits.of(max_pixels, max_memory),
        Output(bits, png_level, threads, "cog" if cog else "tiff" if pyramid else None, compression),
        Device(threads),
        format_,
        metadata,
        exact,
        dither,
        lossy,
        force,
        *how,
    )  # type: ignore[arg-type]
    if output is not None and (many or len(paths) > 1):
        raise UsageError("-o names the OUT of one IN; it does not go with another name, --output-dir or -r")
    if many:
        batch = Batch("decoded", skip_existing, "off" if quiet else progress, as_json, quiet)
        batch.run(batch_items(paths, output_dir, recursive, is_stream), job.extension_of, job.run)
        return
    if len(paths) > 2:
        raise click.UsageError(f"{len(paths)} names; give IN and OUT, or --output-dir for many streams")
    refuse_folder(paths[0], "streams", StreamError)
    target = output or (paths[1] if len(paths) == 2 else None)
    if skip_existing and job.is_there(paths[0], target):
        return
    job.run(paths[0], target)
