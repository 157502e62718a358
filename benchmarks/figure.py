"""The README's picture: a detail of the original, of sgi and of AVIF in as many bytes, and a part of it enlarged."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import click

from benchmarks._sized import TOLERANCE, best_within
from sgicodec import read
from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peers import PEERS
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import require
from sgicodec.metrics.perceptual import perceived
from sgicodec.metrics.psnr import psnr

ZOOM = 16
"""How many times as large the second row shows its part."""

Region = tuple[int, int, int, int]


class _Panel(NamedTuple):
    """A picture [H, W, 3], the same enlarged of the part of the second row, and what stands above both."""

    pixels: Pixels8
    enlarged: Pixels8
    label: str


@click.command()
@click.argument("picture", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("stream", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--region", type=int, nargs=4, default=(60, 130, 272, 208), show_default=True, metavar="X Y W H")
@click.option("--zoom", type=int, nargs=2, default=(203, 224), show_default=True, metavar="X Y")
def main(picture: Path, stream: Path, out: Path, region: Region, zoom: tuple[int, int]) -> None:
    """Draw a detail of PICTURE, of STREAM and of an AVIF in as many bytes side by side to OUT, and below each the part
    from X Y on, 16 times as large.
    """
    require("PIL", "the figure", "bench")
    part = (*zoom, region[2] // ZOOM, region[3] // ZOOM)
    original = read(picture).pixels
    panels = [
        _Panel(original, _enlarged(original, part), f"original, {original.size:,} bytes"),
        _ours(original, stream, part),
        _theirs(original, stream.stat().st_size, part),
    ]
    _draw(panels, region, out)
    click.echo("\n".join(panel.label for panel in panels))


def _ours(original: Pixels8, stream: Path, part: Region) -> _Panel:
    """sgi, whose decoder enlarges."""
    with open_stream(stream) as opened:
        pixels, enlarged = opened.picture().pixels, opened.picture(part, scale=ZOOM).pixels
    return _Panel(pixels, enlarged, _label("sgi", stream.stat().st_size, original, pixels))


def _theirs(original: Pixels8, size: int, part: Region) -> _Panel:
    """The best AVIF of about `size` bytes, or the smallest there is: qualities come in steps."""
    codec = PEERS["avif-iq"]
    most = int(size * TOLERANCE)
    quality = best_within(codec.scale, lambda quality: len(codec.encode(original, quality)), most)
    data = codec.encode(original, codec.scale[0] if quality is None else quality)
    pixels = codec.decode(data)
    return _Panel(pixels, _enlarged(pixels, part), _label("AVIF", len(data), original, pixels))


def _label(name: str, size: int, original: Pixels8, pixels: Pixels8) -> str:
    score = perceived(original, pixels).ssimulacra2
    text = "" if score is None else f"SSIMULACRA 2 {score:.1f}, "
    return f"{name}, {size:,} bytes, {text}{psnr(original, pixels):.2f} dB"


def _enlarged(pixels: Pixels8, part: Region) -> Pixels8:
    """A part of a grid of pixels as viewers enlarge it: bicubic."""
    import numpy as np
    from PIL import Image

    x, y, width, height = part
    size = (width * ZOOM, height * ZOOM)
    box = (x, y, x + width, y + height)
    return np.asarray(Image.fromarray(pixels).resize(size, Image.Resampling.BICUBIC, box))


def _draw(panels: Sequence[_Panel], region: Region, out: Path) -> None:
    from PIL import Image, ImageDraw

    x, y, width, height = region
    sheet = Image.new("RGB", (len(panels) * (width + 8) - 8, 2 * height + 28), "white")
    draw = ImageDraw.Draw(sheet)
    for index, (pixels, enlarged, label) in enumerate(panels):
        left = index * (width + 8)
        draw.text((left + 2, 4), label, fill="black")
        sheet.paste(Image.fromarray(pixels[y : y + height, x : x + width]), (left, 20))
        sheet.paste(Image.fromarray(enlarged), (left, height + 28))
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(out, optimize=True)
