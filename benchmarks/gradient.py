"""What the native SSIMULACRA 2, Butteraugli and their gradients cost, next to the package of the first."""

from __future__ import annotations

import time
from pathlib import Path

import click
import numpy as np

from benchmarks._turns import median_seconds
from sgicodec.bench.codec import Pixels8
from sgicodec.bench.run import load_sample
from sgicodec.device import Device
from sgicodec.errors import require
from sgicodec.metrics.butteraugli import ButteraugliReference
from sgicodec.metrics.perceptual import ssimulacra2
from sgicodec.metrics.visual_score import VisualReference

__all__ = ["HEADINGS", "main"]

HEADINGS = (
    "picture",
    "score",
    "package",
    "reference ms",
    "score ms",
    "gradient ms",
    "package ms",
    "distance",
    "its reference ms",
    "distance ms",
    "its gradient ms",
)


def row(path: Path, device: Device, deviation: float, repeat: int) -> list[str]:
    """The cells of a picture after noise of this deviation, in levels of eight bits."""
    original = load_sample(path).pixels[..., :3]
    noise = np.random.default_rng(0).normal(0, deviation, original.shape)
    decoded: Pixels8 = np.clip(np.rint(original + noise), 0, 255).astype(np.uint8)
    a, b = (np.float32(1 / 255) * pixels.transpose(2, 0, 1).astype(np.float32) for pixels in (original, decoded))
    reference, butteraugli = VisualReference(a, device), ButteraugliReference(a, device)
    times = median_seconds(
        [
            lambda: VisualReference(a, device),
            lambda: reference.score(b),
            lambda: reference.gradient(b),
            lambda: ssimulacra2(original, decoded),
            lambda: ButteraugliReference(a, device),
            lambda: butteraugli.distance(b),
            lambda: butteraugli.gradient(b),
        ],
        repeat,
        time.process_time,
    )
    scores = (f"{score:.4f}" for score in (reference.score(b), ssimulacra2(original, decoded)))
    first, second = ([f"{1e3 * seconds:.1f}" for seconds in part] for part in (times[:4], times[4:]))
    return [path.name, *scores, *first, f"{butteraugli.distance(b)[0]:.4f}", *second]


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--threads", default=1, show_default=True, type=click.IntRange(0), help="0: all cores.")
@click.option("--isa", default="auto", show_default=True, type=click.Choice(["auto", "avx512", "avx2", "portable"]))
@click.option("--deviation", default=6.0, show_default=True, help="Of the noise, in levels of eight bits.")
@click.option("--repeat", default=5, show_default=True, type=click.IntRange(1), help="Runs; medians are printed.")
def main(pictures: tuple[Path, ...], threads: int, isa: str, deviation: float, repeat: int) -> None:
    """Time the native scores and their gradients on PICTURES with noise, in processor time of all threads."""
    require("ssimulacra2", "the benchmark", "bench")
    device = Device(threads, isa)
    click.echo("\t".join(HEADINGS))
    for path in pictures:
        click.echo("\t".join(row(path, device, deviation, repeat)))
