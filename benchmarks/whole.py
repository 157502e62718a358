"""What a variant gains in whole streams, search included: J = D + λR from what is on disk and what is decoded.

    python -m benchmarks.whole PICTURES… --lmbda 0.04 --lmbda 0.01 --variant prior=2 --variant base_cell=32

A variant is one field of EncodeSettings, or base_cell, with another value. 1 % of J is about 2 % of rate; another seed
of the random numbers alone moves J by about 0.5 %.
"""

from __future__ import annotations

import ast
import time
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import mean

import click
import numpy as np

from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile_encoder import Encoded, Encoding
from sgicodec.errors import UsageError
from sgicodec.image import read
from sgicodec.picture import Picture, to_unit

__all__ = ["Whole", "main", "measured", "whole"]


@dataclass(frozen=True)
class Whole:
    """cost: J; error: squared, samples in 0..1, summed over pixels and channels."""

    cost: float
    error: float
    encoded: Encoded


def whole(picture: Picture, settings: EncodeSettings, variant: str = "") -> Whole:
    """Encodes and decodes a picture. Raises UsageError for a variant that is none."""
    base_cell = None
    if variant:
        name, _, value = variant.partition("=")
        try:
            given = ast.literal_eval(value)
            settings, base_cell = (
                (settings, given) if name == "base_cell" else (replace(settings, **{name: given}), None)
            )
        except (ValueError, SyntaxError, TypeError) as cause:
            raise UsageError(f"variant {variant}: a field of EncodeSettings or base_cell, and its value") from cause
    plan = stream_plan(Shape.of(picture), settings)
    if base_cell is not None:
        plan = replace(plan, header=replace(plan.header, spec=replace(plan.header.spec, base_cell=base_cell)))
    return measured(picture, Encoding(picture, plan, time.monotonic()).run(None), settings.threads)


def measured(picture: Picture, encoded: Encoded, threads: int = 0) -> Whole:
    """What the stream of a picture costs: R is its size, D the error of what it decodes to, before rounding."""
    with open_stream(encoded.data) as stream:
        error = float(np.sum((stream.render(threads=threads).astype(np.float64) - to_unit(picture)) ** 2))
    return Whole(error + encoded.lmbda * 8 * len(encoded.data), error, encoded)


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--lmbda", "lambdas", multiple=True, default=(0.02, 0.004), show_default=True, type=float)
@click.option("--variant", "variants", multiple=True, help="Such as prior=2 or base_cell=32.")
@click.option("--steps", default=400, show_default=True, type=click.IntRange(1))
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
def main(
    pictures: tuple[Path, ...], lambdas: tuple[float, ...], variants: tuple[str, ...], steps: int, threads: int
) -> None:
    """Encode PICTURES as they are by default and under each variant, and print how J changes."""
    changes: dict[tuple[str, float], list[float]] = {}
    click.echo("picture\tλ\tvariant\tbytes\tPSNR\tseeds\tpositions\tbase\tJ\tchange")
    for path in pictures:
        picture = read(path)
        for lmbda in lambdas:
            settings = EncodeSettings(lmbda=lmbda, steps=steps, threads=threads)
            plain = whole(picture, settings)
            for variant in ("", *variants):
                one = whole(picture, settings, variant) if variant else plain
                changes.setdefault((variant, lmbda), []).append(one.cost / plain.cost - 1)
                click.echo(_row(path.stem, lmbda, variant, one, picture.pixels.size, changes[variant, lmbda][-1]))
    for (variant, lmbda), values in changes.items():
        if variant:
            click.echo(f"# {variant} at λ = {lmbda:g}: J {100 * mean(values):+.2f} % on average")


def _row(name: str, lmbda: float, variant: str, one: Whole, samples: int, change: float) -> str:
    parts, size = one.encoded.part_bytes, len(one.encoded.data)
    quality = -10 * np.log10(max(one.error / samples, 1e-20))
    cells = [name, f"{lmbda:g}", variant or "default", f"{size}", f"{quality:.2f}", f"{one.encoded.seeds}"]
    cells += [f"{parts['positions']:.0f}", f"{parts.get('base', 0.0):.0f}", f"{one.cost:.2f}", f"{100 * change:+.2f} %"]
    return "\t".join(cells)


if __name__ == "__main__":
    main()
