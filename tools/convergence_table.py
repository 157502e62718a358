"""Measures the convergence table of rate control: how the state of a fit at constant λ relates to its outcome.

    python -m tools.convergence_table PICTURES…

For fractions of the fit, estimated bytes over the stream's bytes of seeds, and PSNR under noise less that of the
decoded picture; the part of the bytes that RDOQ leaves, and the dB that it adds to the PSNR: medians over the
pictures, then the mean deviation of pictures from them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.listener import NullListener
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.inputs import tile_of
from sgicodec.encoder.tile.stages import fit, prepare, rdoq, share
from sgicodec.encoder.tile.writing import stream_of, write
from sgicodec.image import read
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import comparable
from sgicodec.rate_control.convergence import DONE, LMBDAS, STEPS
from sgicodec.rate_control.side_information import SEED_POSITION_BITS

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["followed", "main"]


@dataclass(frozen=True)
class Followed:
    """ratio, offset [DONE]: of bytes, and of PSNR, to the outcome without RDOQ; share, gain: the part of the bytes that
    RDOQ left, and the dB that it added to the PSNR.
    """

    ratio: NDArray[np.float64]
    offset: NDArray[np.float64]
    share: float
    gain: float


def followed(path: Path, lmbda: float, steps: int, device: Device) -> Followed:
    """Fits a picture, RDOQ included."""
    picture = read(path)
    states: list[Progress] = []

    class Noting(NullListener):
        def step(self, progress: Progress) -> bool:
            states.append(progress)
            return True

    settings = EncodeSettings(lmbda=lmbda, steps=steps, hurry=False)  # as those with a target
    tile = tile_of(picture, stream_plan(Shape.of(picture), settings), device, listener=Noting())
    fitted = fit(share(prepare(tile, tile.fit.lmbda)))
    written = [write(state) for state in (fitted, rdoq(fitted))]
    streams = [stream_of(one, tile) for one in written]
    quality = [psnr(comparable(picture), comparable(open_stream(one, device).picture())) for one in streams]
    size = sum(written[0].part_bytes[name] for name in ("positions", "colour", "shape", "offset"))
    at = [states[max(0, math.ceil(done * len(states)) - 1)] for done in DONE]
    ratio = np.array([(state.bits + SEED_POSITION_BITS * state.seeds) / 8 / size for state in at])
    offset = np.array([state.psnr for state in at]) - quality[0]
    return Followed(ratio, offset, len(streams[1]) / len(streams[0]), quality[1] - quality[0])


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
def main(pictures: tuple[Path, ...], threads: int) -> None:
    """Fit PICTURES at three λ and print the tables."""
    for steps in STEPS:
        for lmbda in LMBDAS:
            fits = [followed(path, lmbda, steps, Device(threads)) for path in pictures]
            for name in ("ratio", "offset", "share", "gain"):
                values = np.stack([np.atleast_1d(getattr(fit, name)) for fit in fits])  # [pictures, ·]
                middle = np.median(values, axis=0)
                off = np.abs(values - middle).mean(axis=0)
                for what, row in ((name, middle), (f"{name} off by", off)):
                    click.echo(f"{steps} steps, λ {lmbda:g}, {what}: " + ", ".join(f"{value:.3f}" for value in row))


if __name__ == "__main__":
    main()
