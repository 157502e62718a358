"""How fast the networks of restoration run."""

from __future__ import annotations

import time
from collections.abc import Sequence

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.model.restoration import Restoration

__all__ = ["main", "noisy_edges", "seconds_to_restore"]

STEP = 360
"""Index of a step of 0.07 of the range of samples."""


def noisy_edges(width: int, height: int) -> NDArray[np.float32]:
    """A tile [3, H, W] of edges and noise."""
    x, y = np.arange(width) / 9, np.arange(height)[:, None] / 7
    noise = np.random.default_rng(0).normal(size=(3, height, width)) * 0.05
    return np.asarray(np.sign(np.sin(x + y)) * 0.3 + 0.5 + noise, np.float32)


def seconds_to_restore(restoration: Restoration, drawn: NDArray[np.float32], device: Device, repeat: int) -> float:
    """The least of `repeat` runs."""
    seconds = []
    for _ in range(repeat):
        start = time.perf_counter()
        restoration.correction(drawn, device)
        seconds.append(time.perf_counter() - start)
    return min(seconds)


@click.command()
@click.option("--width", default=2048, show_default=True, type=click.IntRange(1))
@click.option("--height", default=1024, show_default=True, type=click.IntRange(1))
@click.option("--network", default=3, show_default=True, type=click.IntRange(1))
@click.option("--step", default=STEP, show_default=True, type=click.IntRange(0, 511), help="Index of the step.")
@click.option("--isa", "sets", multiple=True, default=("auto",), show_default=True, help="Instruction sets.")
@click.option("--threads", default=1, show_default=True, type=click.IntRange(1))
@click.option("--repeat", default=10, show_default=True, type=click.IntRange(1))
def main(width: int, height: int, network: int, step: int, sets: Sequence[str], threads: int, repeat: int) -> None:
    """Print how long the correction of a picture of three channels takes."""
    drawn, restoration = noisy_edges(width, height), Restoration(network, step)
    click.echo("isa          ms  ns/pixel")
    for isa in sets:
        seconds = seconds_to_restore(restoration, drawn, Device(threads, isa), repeat)
        click.echo(f"{isa:8s} {1e3 * seconds:6.1f}  {1e9 * seconds / (width * height):8.1f}")
