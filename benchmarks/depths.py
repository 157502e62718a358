"""The same picture at several depths and ranges: bytes, and PSNR of the range in use, next to eight bits."""

from __future__ import annotations

import math
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec import decode, encode, read
from sgicodec.errors import SgiError

__all__ = ["COLUMNS", "depths", "main", "range_psnr"]

HOT = 65535
"""What a hot pixel has, which does not count for the PSNR of the others."""
COLUMNS = ("samples", "bytes", "of eight bits", "dB", "more")


def depths(unit: NDArray[np.float64]) -> dict[str, NDArray[np.generic]]:
    """Samples [H, W, C] in 0..1 as pictures of other depths, by name; eight bits first."""

    def integers(top: int) -> NDArray[np.uint16]:
        return np.rint(unit * top).astype(np.uint16)

    hot = integers(4095)
    hot[hot.shape[0] // 2, hot.shape[1] // 2] = HOT
    return {
        "8 bits": np.rint(unit * 255).astype(np.uint8),
        **{f"{bits} of 16 bits": integers((1 << bits) - 1) for bits in (10, 12, 14, 16)},
        "0 to 10000": integers(10000),
        "-2048 to 2047": np.rint(unit * 4095).astype(np.float32) - 2048,
        "float, 0 to 1": unit.astype(np.float32),
        "float, 280 to 297": (280 + 17 * unit).astype(np.float32),
        "12 of 16 bits, a hot pixel": hot,
    }


def range_psnr(original: NDArray[np.generic], decoded: NDArray[np.generic], hot: float | None = None) -> float:
    """PSNR in dB with the range in use as its peak. hot: a value that must come back, and does not count."""
    ours, theirs = original.astype(np.float64).ravel(), decoded.astype(np.float64).ravel()
    if (theirs[ours == hot] != hot).any():
        raise SgiError("a hot pixel did not come back")
    ours, theirs = ours[ours != hot], theirs[ours != hot]
    return 10 * math.log10(float(np.ptp(ours)) ** 2 / float(np.mean((ours - theirs) ** 2)))


def reduced(pixels: NDArray[np.uint8], factor: int) -> NDArray[np.float64]:
    """Samples in 0..1 of the picture in small: means of squares, which are no eight bits."""
    height, width = (side // factor * factor for side in pixels.shape[:2])
    squares = pixels[:height, :width].reshape(height // factor, factor, width // factor, factor, -1)
    return np.asarray(squares.mean(axis=(1, 3)) / 255)


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--quality", default=70.0, show_default=True)
@click.option("--effort", default=5, show_default=True)
@click.option("--crop", default=256, show_default=True, help="Side of the square in the middle; 0 for all.")
@click.option("--reduce", "factor", default=1, show_default=True, help="Reduce first, to samples of more than 8 bits.")
def main(pictures: tuple[Path, ...], quality: float, effort: int, crop: int, factor: int) -> None:
    """Encode PICTURES of eight bits at several depths, at one quality. Tab-separated."""
    for path in pictures:
        unit = reduced(read(path).pixels, factor)
        if crop:
            top, left = ((side - min(side, crop)) // 2 for side in unit.shape[:2])
            unit = unit[top : top + crop, left : left + crop]
        click.echo(f"# {path.name}, {unit.shape[1]}×{unit.shape[0]}, q {quality:g}, effort {effort}")
        click.echo("\t".join(COLUMNS))
        usual: tuple[int, float] | None = None
        for name, pixels in depths(unit).items():
            data = encode(pixels, quality=quality, effort=effort)
            hot = HOT if name.endswith("hot pixel") else None
            found = len(data), range_psnr(pixels, decode(data), hot)
            usual = usual or found
            share, more = 100 * (found[0] / usual[0] - 1), found[1] - usual[1]
            click.echo(f"{name}\t{found[0]}\t{share:+.2f} %\t{found[1]:.2f}\t{more:+.2f}")


if __name__ == "__main__":
    main()
