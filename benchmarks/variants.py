"""How a change of settings changes whole streams: J = D + λR from what is on disk and what is decoded.

A variant is one field of EncodeSettings, base_cell, or `fit.` and a field of FitSettings, with another value. 1 % of J
is about 2 % of rate; another seed of the random numbers alone moves J by about 0.5 %.
"""

from __future__ import annotations

import ast
import math
import time
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import mean
from typing import Any

import click
import numpy as np

from sgicodec.decoder.stream import open_stream
from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.inputs import tile_of
from sgicodec.encoder.tile.stages import encode
from sgicodec.encoder.tile.writing import stream_of, write
from sgicodec.errors import UsageError
from sgicodec.image import read
from sgicodec.picture import Picture, to_unit

__all__ = ["Whole", "main", "measured", "whole"]


@dataclass(frozen=True)
class Whole:
    """cost: J; error: squared, samples in 0..1, summed over pixels and channels; seconds: of the encode, if known."""

    cost: float
    error: float
    encoded: Encoded
    seconds: float = math.nan


def whole(picture: Picture, settings: EncodeSettings, variant: str = "", device: Device = ALL_CORES) -> Whole:
    """Encodes and decodes a picture. Raises UsageError for a variant that is none."""
    name, _, text = variant.partition("=")
    try:
        value: Any = ast.literal_eval(text) if variant else None
        if variant and name != "base_cell" and not name.startswith("fit."):
            settings = replace(settings, **{name: value})
        plan = stream_plan(Shape.of(picture), settings)
        if name == "base_cell":
            plan = replace(plan, header=replace(plan.header, spec=replace(plan.header.spec, base_cell=value)))
        started, tile = time.monotonic(), tile_of(picture, plan, device)
        if name.startswith("fit."):
            tile = replace(tile, fit=replace(tile.fit, **{name.removeprefix("fit."): value}))
    except (ValueError, SyntaxError, TypeError) as cause:
        message = "a field of EncodeSettings, base_cell, or fit. and a field of FitSettings, and its value"
        raise UsageError(f"variant {variant}: {message}") from cause
    written = write(encode(tile))
    gaussians = written.seeds * plan.header.spec.per_seed
    encoded = Encoded(stream_of(written, tile), written.part_bytes, written.seeds, gaussians, written.lmbda)
    return replace(measured(picture, encoded, device), seconds=time.monotonic() - started)


def measured(picture: Picture, encoded: Encoded, device: Device = ALL_CORES) -> Whole:
    """What the stream of a picture costs: R is its size, D the error of what it decodes to, before rounding."""
    with open_stream(encoded.data, device) as stream:
        error = float(np.sum((stream.render().astype(np.float64) - to_unit(picture)) ** 2))
    return Whole(error + encoded.lmbda * 8 * len(encoded.data), error, encoded)


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--lmbda", "lambdas", multiple=True, default=(0.02, 0.004), show_default=True, type=float)
@click.option("--variant", "variants", multiple=True, help="Such as prior=0, base_cell=32 or fit.split=2.5.")
@click.option("--steps", default=400, show_default=True, type=click.IntRange(1))
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
def main(
    pictures: tuple[Path, ...], lambdas: tuple[float, ...], variants: tuple[str, ...], steps: int, threads: int
) -> None:
    """Encode PICTURES with least squared error, plainly and under each variant, and print how J changes."""
    device = Device(threads)
    changes: dict[tuple[str, float], list[float]] = {}
    click.echo("picture\tλ\tvariant\tbytes\tPSNR\tseeds\tpositions\tbase\tseconds\tJ\tchange")
    for path in pictures:
        picture = read(path)
        for lmbda in lambdas:
            settings = EncodeSettings(lmbda=lmbda, steps=steps, tune="psnr")  # J is of squared error
            plain = whole(picture, settings, device=device)
            for variant in ("", *variants):
                one = whole(picture, settings, variant, device) if variant else plain
                changes.setdefault((variant, lmbda), []).append(one.cost / plain.cost - 1)
                click.echo(_row(path.stem, lmbda, variant, one, picture.pixels.size, changes[variant, lmbda][-1]))
    for (variant, lmbda), values in changes.items():
        if variant:
            click.echo(f"# {variant} at λ = {lmbda:g}: J {100 * mean(values):+.2f} % on average")


def _row(name: str, lmbda: float, variant: str, one: Whole, samples: int, change: float) -> str:
    parts, size = one.encoded.part_bytes, len(one.encoded.data)
    quality = -10 * np.log10(max(one.error / samples, 1e-20))
    cells = [name, f"{lmbda:g}", variant or "default", f"{size}", f"{quality:.2f}", f"{one.encoded.seeds}"]
    cells += [
        f"{parts['positions']:.0f}",
        f"{parts.get('base', 0.0):.0f}",
        f"{one.seconds:.1f}",
        f"{one.cost:.2f}",
        f"{100 * change:+.2f} %",
    ]
    return "\t".join(cells)
