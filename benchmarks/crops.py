"""Cuts pictures for a benchmark out of larger ones."""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np

from sgicodec.image import read, write
from sgicodec.picture import Picture, full_range

__all__ = ["along_the_diagonal", "main"]


def along_the_diagonal(picture: Picture, width: int, height: int, count: int) -> list[Picture]:
    """`count` crops at equal distances from corner to corner, 8-bit RGB; the whole picture where it is smaller."""
    width, height = min(width, picture.width), min(height, picture.height)
    low, high = full_range(picture.pixels.dtype)
    found = []
    for number in range(count):
        part = (number + 1) / (count + 1)
        x, y = round(part * (picture.width - width)), round(part * (picture.height - height))
        pixels = picture.pixels[y : y + height, x : x + width, :3].astype(np.float64)
        eight = np.rint((pixels - low) / (high - low) * 255).astype(np.uint8)
        found.append(Picture(eight, "rgb", (0.0, 255.0)))
    return found


@click.command()
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--width", default=768, show_default=True, type=click.IntRange(1))
@click.option("--height", default=512, show_default=True, type=click.IntRange(1))
@click.option("--count", default=2, show_default=True, type=click.IntRange(1), help="Crops of each picture.")
def main(out: Path, pictures: tuple[Path, ...], width: int, height: int, count: int) -> None:
    """Write crops of PICTURES of three or more channels as PNG."""
    out.mkdir(parents=True, exist_ok=True)
    for path in pictures:
        for number, crop in enumerate(along_the_diagonal(read(path), width, height, count)):
            write(crop, out / f"{path.stem}-{number}.png")
