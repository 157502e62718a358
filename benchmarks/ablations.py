"""The paper's ablations on both profiles (`python -m benchmarks.ablations`): K, λ, pyramid levels, components."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np

from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.pipeline import encode
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.image import read
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Picture, comparable

__all__ = ["Row", "centre", "main", "measured", "tables"]

PIXELS_PER_GAUSSIAN = 20
"""In the paper profile, unless a table says otherwise: 3.5 million Gaussians on 70 megapixels."""
FEATURES_PER_GAUSSIAN = 5
"""D and the width of the networks follow K, as in the paper: D = 50 for K = 10."""

PARTS = {
    "x_a": ("positions",),
    "f_a": ("feature", "colour", "shape"),
    "{s_o, s_a}": ("scales",),
    "δ": ("offset",),
    "H": ("hash grid",),
    "MLPs": ("decoders", "context model"),
}
"""The columns of the paper's table of components, and which of a stream's parts they hold."""
SEEDS = ("x_a", "f_a", "{s_o, s_a}", "δ")

Settings = dict[str, EncodeSettings]


@dataclass(frozen=True)
class Row:
    """Means over the pictures: PSNR in dB, bytes, seconds; parts: bytes of each part."""

    psnr: float
    bytes: float
    seconds: float
    parts: Mapping[str, float]


def tables(profile: str, gaussians: int, base: EncodeSettings) -> dict[str, Settings]:
    """Settings of every row of every table, for pictures that get so many Gaussians in the paper profile."""
    if profile == "default":
        return {
            "K": {f"{k}": replace(base, per_seed=k) for k in (1, 2, 4)},
            "λ": {f"{lmbda:g}": replace(base, lmbda=lmbda) for lmbda in (0.0015, 0.003, 0.006, 0.018)},
        }

    def paper(k: int = 10, share: float = 1.0, **others: float) -> EncodeSettings:
        seeds, features = max(1, round(share * gaussians / k)), FEATURES_PER_GAUSSIAN * k
        chosen = replace(base, profile="paper", seeds=seeds, per_seed=k, features=features)
        return replace(chosen, **others)  # type: ignore[arg-type]

    return {
        "K": {f"{k}": paper(k) for k in (5, 10, 15, 20)},
        "λ": {f"{lmbda:g}": paper(lmbda=lmbda) for lmbda in (0.0, 0.0005, 0.001, 0.003)},
        "M": {f"{levels}": paper(levels=levels) for levels in (1, 2, 3, 4)},
        "Gaussians": {f"{round(share * gaussians)}": paper(share=share) for share in (1.0, 2.0, 2.86)},
    }


def measured(pictures: list[Picture], settings: EncodeSettings) -> Row:
    """Encodes and decodes every picture."""
    rows = []
    for picture in pictures:
        started = time.monotonic()
        encoded = encode(picture, settings)
        seconds = time.monotonic() - started
        decoded = open_stream(encoded.data).picture(threads=settings.threads)
        parts = {name: sum(encoded.part_bytes.get(part, 0.0) for part in members) for name, members in PARTS.items()}
        parts["other"] = len(encoded.data) - sum(parts.values())
        rows.append(Row(psnr(comparable(picture), comparable(decoded)), len(encoded.data), seconds, parts))

    def mean(values: list[float]) -> float:
        return sum(values) / len(values)

    parts = {name: mean([row.parts[name] for row in rows]) for name in rows[0].parts}
    return Row(mean([r.psnr for r in rows]), mean([r.bytes for r in rows]), mean([r.seconds for r in rows]), parts)


def centre(picture: Picture, side: int) -> Picture:
    """The middle of a picture, `side` pixels in either direction or all there are."""
    top, left = (max(0, (length - side) // 2) for length in (picture.height, picture.width))
    return replace(picture, pixels=np.ascontiguousarray(picture.pixels[top : top + side, left : left + side]))


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--profile", default="paper", show_default=True, type=click.Choice(["paper", "default"]))
@click.option("--steps", default=1500, show_default=True, type=click.IntRange(5), help="Optimisation steps.")
@click.option("--crop", default=256, show_default=True, type=click.IntRange(16), help="Side of the middle that counts.")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
@click.option("--tables", "chosen", default="", help="Some of K,λ,M,Gaussians.  [default: all]")
def main(pictures: tuple[Path, ...], profile: str, steps: int, crop: int, threads: int, chosen: str) -> None:
    """Encode PICTURES under the settings of the paper's ablations and print means as Markdown rows."""
    crops = [centre(read(path), crop) for path in pictures]
    gaussians = round(sum(p.width * p.height for p in crops) / len(crops) / PIXELS_PER_GAUSSIAN)
    base = EncodeSettings(steps=steps, threads=threads)
    for name, rows in tables(profile, gaussians, base).items():
        if chosen and name not in chosen.split(","):
            continue
        columns = (*PARTS, "other")
        click.echo(f"\n| {name} | PSNR | bytes | of seeds | seconds | " + " | ".join(columns) + " |")
        click.echo("|" + "---|" * (5 + len(columns)))
        for value, settings in rows.items():
            row = measured(crops, settings)
            seeds = sum(row.parts[part] for part in SEEDS)
            shares = " | ".join(f"{100 * row.parts[part] / row.bytes:.1f} %" for part in columns)
            click.echo(f"| {value} | {row.psnr:.2f} | {row.bytes:,.0f} | {seeds:,.0f} | {row.seconds:.1f} | {shares} |")


if __name__ == "__main__":
    main()
