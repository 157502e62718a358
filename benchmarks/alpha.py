"""Pictures with alpha beside AVIF and WebP: bytes, and SSIMULACRA 2 of what is seen over black and over white."""

from __future__ import annotations

import io
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.metrics.visual_score import visual_score

Rgba8 = NDArray[np.uint8]  # [H, W, 4]


def over(pixels: Rgba8, ground: int) -> NDArray[np.uint8]:
    """What is seen of them on a ground of this grey [H, W, 3]."""
    alpha = pixels[..., 3:] / 255.0
    return np.rint(pixels[..., :3] * alpha + ground * (1 - alpha)).astype(np.uint8)


def least_score(original: Rgba8, decoded: Rgba8) -> float:
    """The less of the scores over black and over white."""
    return min(visual_score(over(original, ground), over(decoded, ground)) for ground in (0, 255))


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False))
@click.option("--qualities", default="50,70,85", show_default=True, help="Of sgi and of AVIF.")
def main(pictures: tuple[str, ...], qualities: str) -> None:
    """Print a row for each picture with alpha: bytes and score at each quality, then bytes without loss."""
    click.echo("| picture | sgi | AVIF | without loss: sgi; WebP |\n|---|---|---|---|")
    for path in pictures:
        image = Image.open(path).convert("RGBA")
        points: list[list[str]] = [[], []]
        for quality in map(int, qualities.split(",")):
            points[0].append(_point(image, _encoded(path, EncodeSettings(quality=quality))))
            points[1].append(_point(image, _saved(image, "avif", quality=quality, speed=6)))
        exact = len(_encoded(path, EncodeSettings(max_error=0)))
        ends = f"{exact:,}; {len(_saved(image, 'webp', lossless=True)):,}"
        name = f"{Path(path).stem} ({image.width}×{image.height})"
        click.echo(" | ".join([f"| {name}", *("; ".join(part) for part in points), f"{ends} |"]))


def _point(image: Image.Image, data: bytes) -> str:
    return f"{len(data):,} {least_score(np.asarray(image), _decoded(data)):.1f}"


def _decoded(data: bytes) -> Rgba8:
    if data[4:8] == b"ftyp":
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))
    with open_stream(data) as stream:
        pixels = stream.picture(dtype="uint8").pixels
    mode = {1: "L", 2: "LA", 3: "RGB", 4: "RGBA"}[pixels.shape[2]]
    return np.asarray(Image.fromarray(pixels.squeeze(), mode).convert("RGBA"))


def _encoded(path: str, settings: EncodeSettings) -> bytes:
    return encode_picture(read(path), settings).data


def _saved(image: Image.Image, kind: str, **how: object) -> bytes:
    file = io.BytesIO()
    image.save(file, kind, **how)
    return file.getvalue()
