"""The README's picture: a detail of the original, of sgi, and of JPEG in as many bytes."""

from __future__ import annotations

from pathlib import Path

import click

from sgicodec import read
from sgicodec.bench.peers import Jpeg
from sgicodec.bench.sized import best_within
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import require
from sgicodec.metrics.psnr import psnr

__all__ = ["main"]


@click.command()
@click.argument("picture", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("stream", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--region", type=int, nargs=4, default=(60, 130, 280, 210), show_default=True, metavar="X Y W H")
def main(picture: Path, stream: Path, out: Path, region: tuple[int, int, int, int]) -> None:
    """Draw a detail of PICTURE, of STREAM and of a JPEG as large as STREAM side by side to OUT."""
    require("PIL", "the figure", "bench")
    from PIL import Image, ImageDraw

    original = read(picture).pixels
    size = stream.stat().st_size
    with open_stream(stream) as opened:
        ours = opened.picture().pixels
    jpeg = Jpeg()
    quality = best_within(jpeg.scale, lambda quality: len(jpeg.encode(original, quality)), size)
    data = jpeg.encode(original, jpeg.scale[0] if quality is None else quality)
    theirs = jpeg.decode(data)
    raw = original.size
    panels = [
        (original, f"original, {raw:,} bytes"),
        (ours, f"sgi, {size:,} bytes, {psnr(original, ours):.2f} dB"),
        (theirs, f"JPEG, {len(data):,} bytes, {psnr(original, theirs):.2f} dB"),
    ]
    x, y, width, height = region
    sheet = Image.new("RGB", (3 * width + 16, height + 20), "white")
    draw = ImageDraw.Draw(sheet)
    for index, (pixels, label) in enumerate(panels):
        left = index * (width + 8)
        sheet.paste(Image.fromarray(pixels[y : y + height, x : x + width]), (left, 20))
        draw.text((left + 2, 4), label, fill="black")
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(out, optimize=True)
    click.echo("\n".join(label for _, label in panels))
