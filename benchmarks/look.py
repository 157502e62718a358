"""What each quality looks like: scores over the pictures of a benchmark, and what would bring them nearer together."""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec import read
from sgicodec.encoder.quality_calibration import log_gradients

__all__ = ["main", "missing_steps", "scores_of", "spread"]

F64 = NDArray[np.float64]

Scores = dict[str, dict[float, tuple[float, float]]]
"""SSIMULACRA 2 and bits per pixel, by picture and quality."""


def scores_of(results: Path, codec: str) -> Scores:
    """The rows of a codec in a table that `sgi bench` wrote."""
    found: Scores = defaultdict(dict)
    with results.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file, delimiter="\t"):
            if row["codec"] == codec and row["ssimulacra2"]:
                found[row["picture"]][float(row["quality"])] = float(row["ssimulacra2"]), float(row["bpp"])
    return dict(found)


def spread(scores: Scores) -> list[str]:
    """A line for each quality: mean, least and most of the scores, and the mean rate."""
    lines = []
    for quality in sorted(set.intersection(*(set(points) for points in scores.values()))):
        found = np.array([points[quality] for points in scores.values()])
        score, rate = found.T
        lines.append(f"| {quality:g} | {score.mean():.1f} ({score.min():.1f}–{score.max():.1f}) | {rate.mean():.2f} |")
    return lines


def missing_steps(scores: Scores) -> dict[str, float]:
    """By how many steps of quality each picture is off the mean score, mean over the qualities that can tell."""
    qualities = sorted(set.intersection(*(set(points) for points in scores.values())))
    curves = {name: np.array([points[quality][0] for quality in qualities]) for name, points in scores.items()}
    wanted: F64 = np.mean(list(curves.values()), axis=0)
    found = {}
    for name, curve in curves.items():
        needed: F64 = np.interp(wanted, curve, qualities, left=np.nan, right=np.nan)
        found[name] = float(np.mean((needed - qualities)[1:-1]))
    return found


def _refined(missing: dict[str, float], pictures: tuple[Path, ...]) -> list[str]:
    """What the predictors of the offset could still explain: their coefficients, and what is left."""
    known = [path for path in pictures if np.isfinite(missing.get(path.name, np.nan))]
    features = np.array([log_gradients(read(path), None).mean(axis=0) for path in known])
    steps = np.array([missing[path.name] for path in known])
    columns = np.column_stack([np.ones(len(known)), features - features.mean(axis=0)])
    found, *_ = np.linalg.lstsq(columns, steps, rcond=None)
    left = steps - columns @ found
    return [
        f"steps that {len(known)} pictures miss: standard deviation {steps.std():.2f}, {left.std():.2f} with the four "
        f"coefficients changed by {', '.join(f'{value:+.2f}' for value in found[1:])}"
    ]


@click.command()
@click.argument("results", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("pictures", nargs=-1, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--codec", default="sgi", show_default=True, help="Rows of this name.")
def main(results: Path, pictures: tuple[Path, ...], codec: str) -> None:
    """Tell what each quality looks like in RESULTS, a table of `sgi bench`; with PICTURES, how the offsets of qualities
    (sgicodec/encoder/quality_calibration.py) could be refined.
    """
    scores = scores_of(results, codec)
    if not scores:
        raise click.UsageError(f"{results} has no scores of {codec}")
    click.echo("| `-q` | SSIMULACRA 2 | bpp |\n|---|---|---|")
    for line in [*spread(scores), *(_refined(missing_steps(scores), pictures) if pictures else [])]:
        click.echo(line)
