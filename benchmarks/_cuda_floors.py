"""What the rasteriser's kernels must do, counted, and how long a GPU would at least take for it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.raster import Scene, pairs_within
from sgicodec.cuda import tiles
from sgicodec.cuda.gpu import Gpu
from sgicodec.raster.backend import DEFAULT_CUTOFF


class Peak(NamedTuple):
    """What a GPU does in a second at most: float32 operations, exponentials (16 in a clock on each multiprocessor),
    bytes of memory.
    """

    operations: float
    exponentials: float
    bytes: float


H200 = Peak(66.9e12, 132 * 16 * 1.98e9, 4.8e12)
"""NVIDIA's data sheet of the SXM module: 132 multiprocessors at 1.98 GHz."""


def peak_of(gpu: Gpu) -> Peak:
    """By the properties that the driver states of a GPU: multiprocessors, and clocks at their highest."""
    processors, clock, memory_clock, width = (
        gpu.driver.attribute(gpu.index, number) for number in (_PROCESSORS, _CLOCK, _MEMORY_CLOCK, _BUS_WIDTH)
    )
    capability = gpu.driver.capability(gpu.index)
    lanes = 64 if capability in (75, 80) else 128
    hertz = 1e3 * processors * clock
    return Peak(2 * lanes * hertz, 16 * hertz, 2 * 1e3 * memory_clock * width / 8 or math.inf)


_PROCESSORS, _CLOCK, _MEMORY_CLOCK, _BUS_WIDTH = 16, 13, 36, 37
"""CU_DEVICE_ATTRIBUTE_*: how many, kHz, kHz (two transfers a clock), bits."""


class Counts(NamedTuple):
    """gaussians: how many; pixels: (Gaussian, pixel) pairs within the cutoff; pairs: (tile, Gaussian) pairs, of which
    the boxes around ellipses give at most as many; samples: of the picture.
    """

    gaussians: int
    pixels: int
    pairs: int
    samples: int
    channels: int
    tiles: int


class Floor(NamedTuple):
    """A part of the work: milliseconds that each resource alone would take; the greatest is the floor."""

    name: str
    operations: float
    exponentials: float
    bytes: float

    def milliseconds(self, peak: Peak) -> float:
        """The floor."""
        return 1e3 * max(amount / most for amount, most in zip(self[1:], peak, strict=True))


def counts_of(scene: Scene) -> Counts:
    """Of a scene at the default cutoff."""
    gaussians = scene.gaussians()
    means, covariances, _ = gaussians
    reach = DEFAULT_CUTOFF * np.sqrt(covariances[:, ::2])
    across = _touched(means[:, 0], reach[:, 0], tiles.TILE_WIDTH, scene.width)
    down = _touched(means[:, 1], reach[:, 1], tiles.TILE_HEIGHT, scene.height)
    pixels = pairs_within(gaussians, DEFAULT_CUTOFF, scene.width, scene.height)
    view = tiles.CudaView(scene.width, scene.height)
    samples = scene.channels * scene.width * scene.height
    return Counts(scene.count, pixels, int((across * down).sum()), samples, scene.channels, view.tiles)


def floors(counts: Counts) -> tuple[Floor, ...]:
    """Of squared error with gradients: what any order of work would have to do, but for the pairs of these tiles.

    A pixel of a Gaussian takes 2 subtractions, 7 operations and an exponential for G, 2 C to add colours; backward
    1 and 7 and an exponential, 4 C for colours and their gradients, 1 for w, 6 for moments along a row.
    """
    n, pixels, pairs, samples, channels, count = counts
    sums, digits = tiles.MOMENTS + channels, -(-max(1, (count - 1).bit_length()) // tiles.DIGIT_BITS)
    splat = tiles.SPLAT_BYTES + 4 * channels + 8  # with slot and owner
    return (
        Floor("prepare, list", 120.0 * n, 1.0 * n, 2 * 20 * n + tiles.SPLAT_BYTES * n + 12 * pairs),
        Floor("sort", 0.0, 0.0, digits * 3 * 8 * pairs),
        Floor("forward", (9 + 2 * channels) * pixels, pixels, splat * pairs + 4 * samples),
        Floor("backward", (15 + 4 * channels) * pixels, pixels, (splat + 4 * sums) * pairs),
        Floor("reduce", float(sums * pairs), 0.0, 4 * sums * pairs + 4 * (10 + channels) * n),
    )


def _touched(centre: NDArray[Any], reach: NDArray[Any], side: int, length: int) -> NDArray[np.int64]:
    """How many tiles of the picture an interval of pixel centres touches, by Gaussian."""
    first = np.floor(np.maximum(np.ceil(centre - reach - 0.5), 0) / side)
    last = np.floor(np.minimum(np.floor(centre + reach - 0.5), length - 1) / side)
    touched: NDArray[np.int64] = np.maximum(last - first + 1, 0).astype(np.int64)
    return touched
