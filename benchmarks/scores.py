"""SSIMULACRA 2 as it is computed here, next to what its authors publish for JPEG and JPEG XL.

Their description (Sneyers, 2022 to 2023) names the qualities of libjpeg-turbo, 4:2:0, and the distances of JPEG XL
that typically give 10, 30, 50 and 70.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import click
import numpy as np

from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peers import JpegXl
from sgicodec.bench.run import load_sample
from sgicodec.errors import require
from sgicodec.metrics.perceptual import ssimulacra2

__all__ = ["PUBLISHED", "main"]


def by_jpeg(pixels: Pixels8, quality: float) -> Pixels8:
    """The picture as libjpeg-turbo gives it back, 4:2:0."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "JPEG", quality=round(quality), subsampling="4:2:0")
    return np.asarray(Image.open(buffer))


def by_jpeg_xl(pixels: Pixels8, distance: float) -> Pixels8:
    """The picture as libjxl gives it back at effort 7."""
    return JpegXl().decode(JpegXl().encode(pixels, distance))


PUBLISHED: dict[tuple[str, Callable[[Pixels8, float], Pixels8]], dict[float, float]] = {
    ("JPEG, quality", by_jpeg): {14: 10, 20: 30, 35: 50, 70: 70},
    ("JPEG XL, distance", by_jpeg_xl): {14: 10, 9: 30, 5: 50, 2.5: 70},
}
"""Published score by codec and setting."""


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
def main(pictures: tuple[Path, ...]) -> None:
    """Score PICTURES after JPEG and JPEG XL at the settings whose typical scores are published."""
    for library in ("ssimulacra2", "PIL", "imagecodecs"):
        require(library, "the benchmark", "bench")
    originals = [load_sample(path).pixels for path in pictures]
    click.echo("codec\tsetting\tpublished\tmean\tlowest\thighest")
    for (name, coded), points in PUBLISHED.items():
        for setting, score in points.items():
            found = [ssimulacra2(pixels, coded(pixels, setting)) for pixels in originals]
            values = (f"{value:.1f}" for value in (np.mean(found), min(found), max(found)))
            click.echo("\t".join([name, f"{setting:g}", f"{score:g}", *values]))
