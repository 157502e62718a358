"""Contact sheets: the same places of a picture by all codecs in the same number of bytes, twice as large."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from benchmarks._places import Place, busiest, most_different
from benchmarks._sized import Sized, coded_to_size
from sgicodec.bench.codec import Pixels8
from sgicodec.bench.options import numbers
from sgicodec.bench.peers import Peer, find_peers
from sgicodec.bench.run import Sample, find_pictures, load_sample
from sgicodec.bench.sgi import SgiCodec
from sgicodec.errors import UsageError, require
from sgicodec.metrics.perceptual import perceived
from sgicodec.metrics.psnr import psnr

if TYPE_CHECKING:
    from PIL.Image import Image as Picture
    from PIL.ImageFont import FreeTypeFont, ImageFont

_CROP = (160, 128)  # pixels of the picture, before they are doubled
_COLUMNS = 4
_LABEL = 36  # pixels, two lines
_GAP = 6


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--out", default="sheets", show_default=True, type=click.Path(path_type=Path), help="Folder.")
@click.option("--codecs", default="sgi,jxl,avif-iq", show_default=True, help="sgi, and peers of sgi bench.")
@click.option("--rates", default="0.25,0.5,0.8", show_default=True, help="Bits per pixel.")
@click.option("--place", "places", type=int, nargs=2, multiple=True, metavar="X Y", help="Show this place, repeatable.")
def main(pictures: tuple[Path, ...], out: Path, codecs: str, rates: str, places: tuple[Place, ...]) -> None:
    """Draw details of PICTURES, or of those in folders, by all codecs in as many bytes, as PNG files: the busiest
    place, and that where the codecs differ most, or those of --place.
    """
    for library in ("PIL", "scipy"):
        require(library, "contact sheets", "bench")
    names = [name.strip() for name in codecs.split(",")]
    found, missing = find_peers([name for name in names if name != "sgi"])
    if missing:
        raise UsageError("; ".join(missing.values()))
    chosen: list[SgiCodec | Peer] = [*([SgiCodec()] if "sgi" in names else []), *found]
    asked = numbers(rates, "--rates")
    out.mkdir(parents=True, exist_ok=True)
    for path in find_pictures(pictures):
        sample = load_sample(path)
        height, width = sample.pixels.shape[:2]
        for rate in asked:
            size = int(rate * width * height / 8)
            versions = [coded_to_size(codec, sample.pixels, size) for codec in chosen]
            target = out / f"{Path(sample.name).stem}-{sample.crc}-{rate:g}bpp.png"
            draw_sheet(sample, versions, f"{sample.name}, {rate:g} bpp: {size:,} bytes", places).save(target)
            sizes = ", ".join(f"{version.codec} {version.bytes}" for version in versions)
            click.echo(f"{target}: {size} bytes; {sizes}")


def draw_sheet(sample: Sample, versions: Sequence[Sized], title: str, places: Sequence[Place] = ()) -> Picture:
    """The original and all versions at these places, or at the busiest and at the most different one, a block of panels
    for each. A place that would reach beyond the picture is moved inside.
    """
    from PIL import Image, ImageDraw, ImageFont

    width, height = (min(side, whole) for side, whole in zip(_CROP, sample.pixels.shape[1::-1], strict=True))
    labels = ["original", *(_label(sample.pixels, version) for version in versions)]
    pictures = [sample.pixels, *(version.pixels for version in versions)]
    most = sample.pixels.shape[1] - width, sample.pixels.shape[0] - height
    chosen = [("chosen", (min(x, most[0]), min(y, most[1]))) for x, y in places]
    blocks = chosen or _blocks(sample.pixels, versions, width, height)
    columns = min(_COLUMNS, len(pictures))
    lines = math.ceil(len(pictures) / columns)
    panel_width, panel_height = 2 * width + _GAP, 2 * height + _LABEL + _GAP
    block_height = lines * panel_height + _LABEL
    sheet = Image.new("RGB", (columns * panel_width + _GAP, len(blocks) * block_height + _LABEL), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(14)
    draw.text((_GAP, _GAP), title, "black", ImageFont.load_default(18))
    for number, (name, place) in enumerate(blocks):
        top = _LABEL + number * block_height
        draw.text((_GAP, top + _GAP), f"{name}, at {place[0]}, {place[1]}", "black", font)
        for index, (pixels, label) in enumerate(zip(pictures, labels, strict=True)):
            left = _GAP + index % columns * panel_width
            y = top + _LABEL - _GAP + index // columns * panel_height
            _draw_panel(sheet, (left, y), pixels, place, (width, height), label, font)
    return sheet


def _draw_panel(
    sheet: Picture,
    corner: tuple[int, int],
    pixels: Pixels8 | None,
    place: Place,
    size: tuple[int, int],
    label: str,
    font: FreeTypeFont | ImageFont,
) -> None:
    """A label, and under it the place at twice its size, every pixel as a square of four."""
    from PIL import Image, ImageDraw

    ImageDraw.Draw(sheet).multiline_text((corner[0], corner[1]), label, "black", font, spacing=2)
    if pixels is not None:
        (x, y), (width, height) = place, size
        crop = np.repeat(np.repeat(pixels[y : y + height, x : x + width], 2, axis=0), 2, axis=1)
        sheet.paste(Image.fromarray(crop), (corner[0], corner[1] + _LABEL))


def _blocks(original: Pixels8, versions: Sequence[Sized], width: int, height: int) -> list[tuple[str, Place]]:
    busy = busiest(original, width, height)
    blocks = [("busiest", busy)]
    decoded = [version.pixels for version in versions if version.pixels is not None]
    if len(decoded) > 1:
        blocks.append(("most different", most_different(original, decoded, width, height, [busy])))
    return blocks


def _label(original: Pixels8, version: Sized) -> str:
    """Codec and bytes, then the scores over the whole picture; what is not installed is left out."""
    if version.pixels is None:
        return f"{version.codec}\n{version.note[:44]}"
    seen = perceived(original, version.pixels)
    scores = [f"{psnr(original, version.pixels):.2f} dB"]
    if seen.ssimulacra2 is not None:
        scores.append(f"SSIMULACRA 2 {seen.ssimulacra2:.1f}")
    if seen.butteraugli is not None:
        scores.append(f"B {seen.butteraugli:.2f}")
    return f"{version.codec}, {version.bytes:,} bytes\n{', '.join(scores)}"
