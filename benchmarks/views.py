"""What small views cost, and how near they are to the whole model"""

from __future__ import annotations

import time
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.decoder.view import Region
from sgicodec.device import Device
from sgicodec.metrics.psnr import psnr

__all__ = ["averaged", "main", "thumbnail"]

F32 = NDArray[np.float32]

SHRINKS = (4, 8, 12, 16, 24, 32, 48, 64)


def thumbnail(path: Path, shrink: int, exact: bool, threads: int, repeat: int) -> tuple[F32, float]:
    """Samples [h, w, C] of a stream at 1 / shrink, as far as pixels are whole, `exact` or as the decoder chooses, and
    the least seconds of `repeat` runs from an open file to pixels.
    """
    seconds = []
    for _ in range(repeat):
        start = time.perf_counter()
        with open_stream(path, Device(threads)) as stream:
            stream.exact = exact
            samples = stream.render(*_whole(stream, shrink))
        seconds.append(time.perf_counter() - start)
    return np.clip(samples, 0, 1), min(seconds)


def _whole(stream: Stream, shrink: int) -> tuple[Region, None, tuple[int, int]]:
    """Region, scale and size of the pixels at 1 / shrink that are whole."""
    columns, rows = stream.width // shrink, stream.height // shrink
    return (0, 0, columns * shrink, rows * shrink), None, (columns, rows)


def averaged(pixels: NDArray[np.uint8], shrink: int) -> F32:
    """Means in 0..1 of blocks of shrink × shrink pixels; those that are not whole are left out."""
    rows, columns = (side // shrink for side in pixels.shape[:2])
    blocks = pixels[: rows * shrink, : columns * shrink].reshape(rows, shrink, columns, shrink, -1)
    return np.asarray(blocks.mean(axis=(1, 3)) / 255, np.float32)


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option("--source", type=click.Path(path_type=Path, exists=True), help="The picture of 8 bits that was encoded.")
@click.option("--shrink", "shrinks", multiple=True, type=click.IntRange(1), default=SHRINKS, show_default=True)
@click.option("--threads", default=1, show_default=True, type=click.IntRange(1))
@click.option(
    "--repeat", default=3, show_default=True, type=click.IntRange(1), help="Runs, of which the fastest counts."
)
def main(paths: tuple[Path, ...], source: Path | None, shrinks: tuple[int, ...], threads: int, repeat: int) -> None:
    """Print for each stream and scale the PSNR of the usual view against what the whole model gives there, that of both
    against the averaged source, and milliseconds.
    """
    pixels = None
    if source is not None:
        from sgicodec.image import read

        pixels = read(source).pixels
    for path in paths:
        click.echo(f"{path}\n\n| scale | rendered from | PSNR to all | PSNR to source | ms | of all |")
        click.echo("|---|---|---:|---:|---:|---:|")
        for shrink in shrinks:
            mean = None if pixels is None else averaged(pixels, shrink)
            runs = {name: thumbnail(path, shrink, name == "all", threads, repeat) for name in ("all", "as usual")}
            for name, (samples, seconds) in runs.items():
                near = "" if name == "all" else f"{psnr(samples, runs['all'][0]):.1f}"
                true = "" if mean is None else f"{psnr(samples, mean):.2f}"
                share = f"{seconds / runs['all'][1]:.2f}"
                click.echo(f"| 1/{shrink} | {name} | {near} | {true} | {1e3 * seconds:.0f} | {share} |")
        click.echo()
