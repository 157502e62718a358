"""Makes a large picture of real ones.

Cells are crops of the pictures, side by side; once all crops were used they come again mirrored or turned.
"""

from __future__ import annotations

from itertools import product
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec.image import read, write
from sgicodec.picture import Picture

__all__ = ["crops", "main", "mosaic"]

Pixels = NDArray[np.uint8]


def crops(pixels: Pixels, cell: int) -> list[Pixels]:
    """The whole cells [cell, cell, C] that lie in a picture [H, W, C], row by row."""
    rows, columns = pixels.shape[0] // cell, pixels.shape[1] // cell
    return [
        pixels[y * cell : (y + 1) * cell, x * cell : (x + 1) * cell] for y, x in product(range(rows), range(columns))
    ]


def mosaic(cells: list[Pixels], side: int) -> Pixels:
    """Cells [cell, cell, C], turned a further way each time round, on a square of at most `side` pixels a side."""
    cell = len(cells[0])
    count = side // cell
    out = np.empty((count * cell, count * cell, cells[0].shape[2]), np.uint8)
    for number, (y, x) in enumerate(product(range(count), range(count))):
        turn, index = divmod(number, len(cells))
        turned = np.rot90(cells[index][:, :: -1 if turn & 1 else 1], turn >> 1)
        out[y * cell : (y + 1) * cell, x * cell : (x + 1) * cell] = turned
    return out


@click.command()
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--side", default=12288, show_default=True, type=click.IntRange(1), help="Pixels across and down, at most."
)
@click.option("--cell", default=2048, show_default=True, type=click.IntRange(1), help="Pixels a side of each crop.")
def main(out: Path, pictures: tuple[Path, ...], side: int, cell: int) -> None:
    """Write a mosaic of 8-bit PICTURES with equal channels to OUT."""
    read_in = [read(path) for path in pictures]
    cells = [crop for picture in read_in for crop in crops(picture.pixels, cell)]
    if not cells or len({(*crop.shape[2:], crop.dtype) for crop in cells}) != 1 or cells[0].dtype != np.uint8:
        raise click.UsageError(f"no cells of {cell}×{cell} pixels, or of several kinds")
    pixels = mosaic(cells, side)
    write(Picture(pixels, read_in[0].channels, (0.0, 255.0)), out)
    click.echo(f"{pixels.shape[1]}×{pixels.shape[0]} pixels of {len(cells)} crops")
