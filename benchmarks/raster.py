"""How fast the native rasteriser is, and how near to what the cores can do."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import click
import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks._turns import median_seconds
from sgicodec import _native
from sgicodec.arrays import F32
from sgicodec.device import Device
from sgicodec.model.morton import morton
from sgicodec.raster.backend import DEFAULT_CUTOFF
from sgicodec.raster.cpu import NativeRasterizer

Gaussians = tuple[F32, F32, F32]

START = 34
"""Floating-point operations per lane to start a run of rows: the offset, two exponents, two exponentials of 13."""
SPAN = 8
"""Rows of a run, for all but the thinnest Gaussians."""


@dataclass(frozen=True)
class Scene:
    """Gaussians strewn evenly over a picture; `sigma` is the geometric mean of their deviations, pixels."""

    count: int
    sigma: float
    width: int = 2040
    height: int = 1356
    channels: int = 3

    def gaussians(self, seed: int = 0) -> Gaussians:
        """Means, covariances, colours: log-normal deviations (30 %) at any angle, in Morton order as in a stream."""
        rng = np.random.default_rng(seed)
        means = rng.random((self.count, 2)) * [self.width, self.height]
        means = means[np.argsort(morton(means[:, 0].astype(np.int64), means[:, 1].astype(np.int64)))]
        first, second = (self.sigma * np.exp(0.3 * rng.normal(size=(2, self.count)))) ** 2
        angle = rng.random(self.count) * np.pi
        cos, sin = np.cos(angle), np.sin(angle)
        covariances = np.stack(
            [
                cos * cos * first + sin * sin * second,
                cos * sin * (first - second),
                sin * sin * first + cos * cos * second,
            ],
            axis=1,
        )
        colours = rng.random((self.count, self.channels)) - 0.5
        return means.astype(np.float32), covariances.astype(np.float32), colours.astype(np.float32)


@dataclass(frozen=True)
class Speed:
    """Median seconds of each pass; pixels within the cutoff of all Gaussians."""

    forward: float
    squared_error: float
    pairs: int


def forward_operations(channels: int) -> float:
    """Floating-point operations per Gaussian and pixel: `channels` multiply-adds, the recurrence, the start."""
    return 2 * channels + 2 + START / SPAN


def backward_operations(channels: int) -> float:
    """The same for the backward pass: colours' gradients and their product, six moments of which three per row, the
    recurrence, the start; without the sums over a tile.
    """
    return 4 * channels + 8 + START / SPAN


def pairs_within(gaussians: Gaussians, cutoff: float, width: int, height: int) -> int:
    """How many (Gaussian, pixel) pairs lie within `cutoff` standard deviations: the work that is asked for."""
    x, y = gaussians[0].astype(np.float64).T
    xx, xy, yy = gaussians[1].astype(np.float64).T
    reach = cutoff * np.sqrt(yy)
    first = np.maximum(0, np.ceil(y - reach - 0.5)).astype(np.int64)
    last = np.minimum(height - 1, np.floor(y + reach - 0.5)).astype(np.int64)
    total = 0
    for step in range(int((last - first).max(initial=-1)) + 1):
        dy = first + step + 0.5 - y
        centre = x + xy / yy * dy
        half = np.sqrt(np.maximum(0, (cutoff**2 - dy * dy / yy) * (xx - xy * xy / yy)))
        left = np.maximum(0, np.ceil(centre - half - 0.5))
        right = np.minimum(width - 1, np.floor(centre + half - 0.5))
        total += int(np.maximum(0, right - left + 1)[first + step <= last].sum())
    return total


def measure(scene: Scene, threads: int = 0, isa: str = "auto", repeat: int = 20) -> Speed:
    """Times both passes in turn, `repeat` times, so that a busy machine slows them alike."""
    gaussians = scene.gaussians()
    target = np.random.default_rng(1).random((scene.channels, scene.height, scene.width), np.float32)
    raster = NativeRasterizer(Device(threads, isa))
    passes: list[Callable[[], object]] = [
        lambda: raster.forward(*gaussians, scene.width, scene.height),
        lambda: raster.error(*gaussians, target),
    ]
    forward, squared_error = median_seconds(passes, repeat)
    pairs = pairs_within(gaussians, DEFAULT_CUTOFF, scene.width, scene.height)
    return Speed(forward, squared_error, pairs)


def peak_of(threads: int, repeat: int = 5) -> float:
    """Operations per second that this many threads reach at best: those of BLAS in a product of matrices."""
    side = 2048
    matrix = np.random.default_rng(0).random((side, side), np.float32)
    best = np.inf
    with threadpool_limits(threads):
        for _ in range(repeat):
            start = time.perf_counter()
            np.matmul(matrix, matrix)
            best = min(best, time.perf_counter() - start)
    return 2 * side**3 / best


def report(scene: Scene, speed: Speed, peak: float) -> str:
    """One line of the table; `peak` in operations per second."""
    rates, shares = [], []
    for seconds, operations in (
        (speed.forward, forward_operations(scene.channels)),
        (speed.squared_error, forward_operations(scene.channels) + backward_operations(scene.channels)),
    ):
        rates.append(f"{speed.pairs / seconds / 1e9:.2f}")
        shares.append(f"{100 * speed.pairs * operations / seconds / peak:.0f} %")
    times = [f"{1e3 * seconds:.1f}" for seconds in (speed.forward, speed.squared_error)]
    cells = [f"{scene.count:,}", f"{scene.sigma:g}", *times, f"{speed.pairs / 1e6:.0f}", *rates, *shares]
    return "| " + " | ".join(cells) + " |"


SCENES = (Scene(50_000, 4.0), Scene(500_000, 1.3))

HEADINGS = (
    "Gaussians",
    "σ px",
    "forward ms",
    "squared error ms",
    "Mpairs",
    "forward Gpairs/s",
    "squared error Gpairs/s",
    "forward of peak",
    "squared error of peak",
)


@click.command()
@click.option("--threads", default=0, show_default="all cores", type=click.IntRange(0))
@click.option("--isa", default="auto", show_default=True, type=click.Choice(["auto", "avx512", "avx2", "portable"]))
@click.option("--repeat", default=20, show_default=True, type=click.IntRange(1), help="Runs; medians are printed.")
def main(threads: int, isa: str, repeat: int) -> None:
    """Time the native rasteriser on 2040×1356 pixels of three channels."""
    try:
        name = NativeRasterizer(Device(threads, isa)).isa
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    count = _native.resolve_threads(threads)
    before = peak_of(count)
    lines = []
    for scene in SCENES:
        lines.append((scene, measure(scene, threads, isa, repeat)))
    peak = max(before, peak_of(count))
    workers = "1 thread" if count == 1 else f"{count} threads"
    click.echo(f"{name}, {workers}, products of matrices at {peak / 1e9:.0f} GFLOP/s, median of {repeat} runs\n")
    click.echo("| " + " | ".join(HEADINGS) + " |\n|" + "---:|" * len(HEADINGS))
    for scene, speed in lines:
        click.echo(report(scene, speed, peak))
