"""Decisions between the passes over the tiles of a picture: which tiles a pass fits, and when λ is too far off."""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

__all__ = ["MAX_FITS", "MAX_SAMPLES", "is_far", "kept_near", "spread_over", "tiles_of_pass"]

MAX_SAMPLE_TILES = 8
"""Tiles of the first pass."""
MIN_TILES_FOR_HALVES = 12
"""From this many tiles on, half of the others come before the rest and correct λ once more."""
LMBDA_SPREAD_OCTAVES = 0.5
"""How far the λ of the fits of one stream may lie apart."""
MAX_SAMPLES, MAX_FITS = 4, 2
"""How often a sample is fitted, and how often all tiles are."""


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
