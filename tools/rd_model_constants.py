"""Compares the R-D model with encodes, and solves for the exponents of its products of powers
(`python -m tools.rd_model_constants PICTURES…`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec.bench.options import numbers
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.effort import PLAIN_STEPS
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.fit.base_layer import base_layer
from sgicodec.image import read
from sgicodec.metrics.distortion import decibels
from sgicodec.metrics.psnr import psnr
from sgicodec.model.layout import ROOT_LOG, cell_sums
from sgicodec.picture import comparable, to_unit
from sgicodec.profiles.default import default_settings, lmbda_of_quality
from sgicodec.rate_control.rd_model import EMPTY_STREAM_BYTES, HIGHER_PRICE, RdModel

__all__ = ["Outcome", "exponents", "main", "outcomes"]


@dataclass(frozen=True)
class Outcome:
    """bytes of the stream and squared error of a sample; both predicted; seeds: λ, their number for each pixel and the
    deviation within their cells, the same at four times the price; pixels of the picture.
    """

    picture: str
    quality: float
    bytes: int
    error: float
    predicted: tuple[float, float]
    seeds: tuple[float, float, float, float, float]
    pixels: int


def outcomes(path: Path, qualities: list[float], effort: int, threads: int) -> list[Outcome]:
    """Predicts and encodes a picture at each quality."""
    picture, found = read(path), []
    spec = stream_plan(Shape.of(picture), EncodeSettings()).header.spec
    unit = np.ascontiguousarray(to_unit(picture).transpose(2, 0, 1))
    for quality in qualities:
        lmbda = lmbda_of_quality(quality)
        sums = cell_sums(base_layer(spec, unit, lmbda)[2], ROOT_LOG)
        price = default_settings(lmbda, PLAIN_STEPS[effort]).split_price
        rd_model = RdModel(sums, len(unit), unit[0].size, price)
        settings = EncodeSettings(quality=quality, effort=effort, low_effort=False)
        data = encode_picture(picture, settings, device=Device(threads)).data
        decoded = open_stream(data, Device(threads)).picture()
        error = 10 ** (-0.1 * psnr(comparable(picture), comparable(decoded)))
        seeds = lmbda, *rd_model.seeds(lmbda), *rd_model.seeds(lmbda, HIGHER_PRICE)
        found.append(Outcome(path.stem, quality, len(data), error, rd_model.predict(lmbda), seeds, unit[0].size))
    return found


def exponents(found: list[Outcome], of_error: bool) -> tuple[NDArray[np.float64], float]:
    """A factor and the exponents of `seeds` that predict the error, or the bytes for each pixel, by least squares of
    logarithms; and how far off these are, in octaves (standard deviation).
    """
    wanted = [one.error if of_error else max(one.bytes - EMPTY_STREAM_BYTES, 1.0) / one.pixels for one in found]
    rows = np.array([[1.0, *np.log(one.seeds)] for one in found])
    solved, *_ = np.linalg.lstsq(rows, np.log(wanted), rcond=None)
    off = float(np.std(rows @ solved - np.log(wanted))) / math.log(2)
    return np.array([math.exp(solved[0]), *solved[1:]]), off


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--qualities", default="15,35,55,75", show_default=True)
@click.option("--effort", default=3, show_default=True, type=click.IntRange(1, 9))
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
def main(pictures: tuple[Path, ...], qualities: str, effort: int, threads: int) -> None:
    """Print bytes and PSNR of PICTURES and by how many octaves of bytes and squared error the model was off."""
    asked, found = numbers(qualities, "--qualities"), list[Outcome]()
    click.echo("picture\tquality\tbytes\tPSNR\tbytes off\terror off")
    for path in pictures:
        for one in outcomes(path, asked, effort, threads):
            if one.error > 0:
                found.append(one)
                size, error = _off(one)
                quality = decibels(one.error, 1)
                click.echo(f"{one.picture}\t{one.quality:g}\t{one.bytes}\t{quality:.2f}\t{size:+.2f}\t{error:+.2f}")
    for name, off in zip(("bytes", "error"), zip(*map(_off, found), strict=True), strict=True):
        click.echo(f"# {name} off by {np.mean(off):+.2f} ± {np.std(off):.2f} octaves")
        best, left = exponents(found, name == "error")
        told = ", ".join(f"{value:.3f}" for value in best)
        click.echo(f"# least squares: factor and exponents of λ, seeds, deviation, both at 4 λ: {told}; ± {left:.2f}")


def _off(one: Outcome) -> tuple[float, float]:
    """log2 of what came over what was predicted."""
    return math.log2(one.bytes / one.predicted[0]), math.log2(one.error / one.predicted[1])


if __name__ == "__main__":
    main()
