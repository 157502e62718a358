"""How the state of a fit at constant λ relates to its outcome: prints the tables of `fit/course.py`.

    python -m sgicodec.bench.course PICTURES…

For fractions of the fit, estimated bytes over the stream's bytes of seeds, and PSNR under noise less that of the
decoded picture: medians over the pictures, then how far pictures are off on average.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec.decoder import open_stream
from sgicodec.encoder import EncodeSettings, encode
from sgicodec.fit.course import DONE, LAMBDAS, POSITION_BITS, STEPS
from sgicodec.image import comparable, read
from sgicodec.metrics import psnr

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["followed", "main"]


def followed(path: Path, lmbda: float, steps: int, threads: int) -> NDArray[np.float64]:
    """Fits a picture; for each of DONE the ratio of bytes and the difference of PSNR to what came [2, DONE]."""
    picture = read(path)
    states: list[Progress] = []

    def on_progress(state: Progress) -> bool:
        states.append(state)
        return True

    encoded = encode(picture, EncodeSettings(lmbda=lmbda, steps=steps, threads=threads, refine=False), on_progress)
    reached = psnr(comparable(picture), comparable(open_stream(encoded.data).picture(threads=threads)))
    size = sum(encoded.part_bytes[name] for name in ("positions", "colour", "shape", "offset"))
    at = [states[max(0, math.ceil(done * len(states)) - 1)] for done in DONE]
    ratio = [(state.bits + POSITION_BITS * state.seeds) / 8 / size for state in at]
    return np.array([ratio, [state.psnr - reached for state in at]])


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
def main(pictures: tuple[Path, ...], threads: int) -> None:
    """Fit PICTURES at three λ and print the tables."""
    for steps in STEPS:
        for lmbda in LAMBDAS:
            courses = np.stack([followed(path, lmbda, steps, threads) for path in pictures])  # [pictures, 2, DONE]
            middle = np.median(courses, axis=0)
            off = np.abs(courses - middle).mean(axis=0)
            for number, name in enumerate(("ratio", "lift")):
                for what, row in ((name, middle[number]), (f"{name} off by", off[number])):
                    click.echo(f"{steps} steps, λ {lmbda:g}, {what}: " + ", ".join(f"{value:.3f}" for value in row))


if __name__ == "__main__":
    main()
