"""How fast texture layers are drawn."""

from __future__ import annotations

import time
from collections.abc import Sequence

import click
import numpy as np

from sgicodec.device import Device
from sgicodec.model.texture import LEAST_LOG, ROOT_LOG, TextureLayer

__all__ = ["full_layer", "main", "seconds_to_draw"]


def full_layer(width: int, height: int, log_size: int, share: float, channels: int = 3) -> TextureLayer:
    """Cells of one size over a whole picture, with amplitudes in this share of the frequencies along each axis."""
    side = 1 << log_size
    x, y = np.meshgrid(np.arange(0, width, side), np.arange(0, height, side))
    corner = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.int32)
    amplitudes = np.random.default_rng(0).normal(size=(len(corner), channels, side, side)).astype(np.float32)
    held = max(1, round(side * share))
    amplitudes[:, :, held:] = 0
    amplitudes[:, :, :, held:] = 0
    log_sizes = np.full(len(corner), log_size, np.uint8)
    return TextureLayer((width, height), channels, corner, log_sizes, amplitudes.ravel())


def seconds_to_draw(layer: TextureLayer, scale: float, device: Device, repeat: int) -> float:
    """The least of `repeat` runs."""
    width, height = (max(1, round(side * scale)) for side in layer.size)
    seconds = []
    for _ in range(repeat):
        start = time.perf_counter()
        layer.draw(scale=(scale, scale), size=(width, height), device=device)
        seconds.append(time.perf_counter() - start)
    return min(seconds)


@click.command()
@click.option("--width", default=2048, show_default=True, type=click.IntRange(1))
@click.option("--height", default=1024, show_default=True, type=click.IntRange(1))
@click.option("--share", "shares", multiple=True, type=click.FloatRange(0, 1), default=(1.0, 0.5, 0.25))
@click.option("--scale", "scales", multiple=True, type=click.FloatRange(0, 8, min_open=True), default=(1.0,))
@click.option("--isa", "sets", multiple=True, default=("auto",), show_default=True, help="Instruction sets.")
@click.option("--threads", default=1, show_default=True, type=click.IntRange(1))
@click.option("--repeat", default=10, show_default=True, type=click.IntRange(1))
def main(
    width: int,
    height: int,
    shares: Sequence[float],
    scales: Sequence[float],
    sets: Sequence[str],
    threads: int,
    repeat: int,
) -> None:
    """Print how long it takes to draw texture of three channels everywhere, for cells of each size, a share of the
    frequencies along each axis, and scales.
    """
    click.echo("cells  share  scale  isa        ms")
    for log_size in range(LEAST_LOG, ROOT_LOG + 1):
        for share in shares:
            layer = full_layer(width, height, log_size, share)
            for scale in scales:
                for isa in sets:
                    seconds = seconds_to_draw(layer, scale, Device(threads, isa), repeat)
                    click.echo(f"{1 << log_size:5d}  {share:5.2f}  {scale:5.2f}  {isa:8s} {1000 * seconds:5.1f}")
