"""Decisions between the passes over the tiles of a picture: which tiles a pass fits, when λ is too far off, and by how
much to move the λ of how many tiles when all of them together missed a target.

A correction searches texture of another step over the seeds that are coded: fast, and it goes both ways.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["MAX_FITS", "MAX_SAMPLES", "is_far", "kept_near", "next_correction", "spread_over", "tiles_of_pass"]


MAX_SAMPLE_TILES = 8
"""Tiles of the first pass."""
MIN_TILES_FOR_HALVES = 12
"""From this many tiles on, half of the others come before the rest and correct λ once more."""
LMBDA_SPREAD_OCTAVES = 0.5
"""How far the λ of the fits of one stream may lie apart."""
MAX_SAMPLES, MAX_FITS = 4, 2
"""How often a sample is fitted, and how often all tiles are. Passes were measured:
docs/notes/2026-11-rate-control.md."""


def tiles_of_pass(predicted: NDArray[np.float64], done: Collection[int]) -> list[int]:
    """The tiles to fit next. predicted [tiles]: what the R-D model predicts of each."""
    count = len(predicted)
    samples = min(MAX_SAMPLE_TILES, max(2, count // 4))
    if not done:
        return spread_over(predicted, samples)
    rest = [number for number in range(count) if number not in done]
    return rest[::2] if len(done) <= samples and count >= MIN_TILES_FOR_HALVES else rest


def is_far(one: float, other: float) -> bool:
    """Whether two λ lie too far apart for the fits of one stream."""
    return abs(math.log2(one / other)) > LMBDA_SPREAD_OCTAVES


def kept_near(lmbda: float, middle: float) -> float:
    """λ moved to where it is not too far from `middle`."""
    return min(max(lmbda, middle / 2**LMBDA_SPREAD_OCTAVES), middle * 2**LMBDA_SPREAD_OCTAVES)


def spread_over(weights: NDArray[np.float64], count: int) -> list[int]:
    """Up to `count` indices, spread evenly over the cumulative weights."""
    behind = np.cumsum(weights + 1e-9 * (weights.sum() + 1.0))
    marks = (np.arange(count) + 0.5) / count * behind[-1]
    return sorted(set(np.searchsorted(behind, marks).tolist()))


SLOPE = 0.35
"""Octaves of bytes or error that an octave of λ moves, before it is measured."""
MIN_OCTAVES, MAX_OCTAVES = 0.1, 4.0
"""By which λ of single tiles moves."""
OVERSHOOT = 1.3
"""Factor on what seems to be needed of some tiles."""
MARGIN = 0.01
"""Octaves of bytes or error by which later corrections go beyond what is needed."""
MIN_TILES = 4
MIN_STEP_OCTAVES = 1e-3
"""λ that differ by less say nothing of the slope."""
MIN_FIRST_STEP = 0.2
"""Part of `MIN_OCTAVES` by which λ of all tiles moves at least, as long as nothing was tried."""


def next_correction(
    coarser: bool,
    left: float,
    shares: dict[int, float],
    fresh: Sequence[int],
    tried: Sequence[tuple[float, float]],
) -> tuple[float, list[int]]:
    """Octaves by which to move the λ of which tiles. coarser: whether the fits spend too much, so that λ rises. left:
    error of the best allocation. shares: what each tile has of the total. fresh: tiles that were not corrected yet, of
    which some suffice where the error is small. tried: octaves, and the error if all tiles moved by them.
    """
    direction = 1 if coarser else -1
    if fresh and left * direction > 0:
        octaves, numbers = _of_fresh(left, shares, fresh)
        return direction * octaves, numbers
    last, slope = tried[-1][0] if tried else 0.0, SLOPE
    if len(tried) > 1 and abs(last - tried[-2][0]) > MIN_STEP_OCTAVES:
        slope = min(max((tried[-2][1] - tried[-1][1]) / (last - tried[-2][0]), 0.3 * slope), 3 * slope)
    error = tried[-1][1] if tried else left
    beyond = math.copysign(MARGIN, error) if tried else 0.0
    wanted = direction * (last + (error + beyond) / slope)
    # All tiles may have overshot: then back, past the fits.
    lowest = -MIN_OCTAVES if tried else MIN_FIRST_STEP * MIN_OCTAVES
    return direction * min(max(wanted, lowest), MAX_OCTAVES), list(shares)


def _of_fresh(left: float, shares: dict[int, float], fresh: Sequence[int]) -> tuple[float, list[int]]:
    """The same of tiles that were not corrected yet; octaves without their sign."""
    part = sum(shares[number] for number in fresh) / max(sum(shares.values()), 1e-9)
    wanted = OVERSHOOT * abs(left) / SLOPE / max(part, 1e-3)
    count = max(MIN_TILES, math.ceil(len(fresh) * wanted / MIN_OCTAVES))
    numbers = list(fresh)
    if count < len(numbers):
        numbers = [numbers[at] for at in spread_over(np.array([shares[number] for number in fresh]), count)]
    return min(max(wanted, MIN_OCTAVES), MAX_OCTAVES), numbers
