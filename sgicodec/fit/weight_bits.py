"""Weights that travel in a stream: what their bits cost, and the noise of their steps."""

from __future__ import annotations

import math

import numpy as np

from sgicodec.arrays import F32
from sgicodec.fit.noise import NoiseKey, hashed_noise

ADDED_UNITS = 0.05
"""Units that are added to a mean magnitude, so that an array of zeros has a price."""


def price_slope(weights: F32, shift: int, price: float) -> F32:
    """Gradient of `price` times the bits of weights in units of 2^-shift, under the Laplacian of their own mean
    magnitude, which is taken as given.
    """
    mean = float(np.abs(weights).mean()) * 2.0**shift + ADDED_UNITS
    slope: F32 = np.float32(price * 2.0**shift / (mean * math.log(2.0))) * np.sign(weights)
    return slope


def decoder_shift(seeds: int) -> int:
    """Of the decoders' weights: 2^-7 for 1,000 seeds, a bit more for four times as many.

    A bit costs as much for any number of seeds, and what it gains in distortion grows with them
    (docs/notes/2026-11-paper-profile.md, "Decoders").
    """
    return int(np.clip(round(7 + math.log(max(seeds, 1) / 1000, 4)), 5, 14))


def with_weight_noise(weights: F32, shift: int, key: NoiseKey, column: int) -> F32:
    """Weights [n] under noise of a unit of 2^-shift, drawn as that of an attribute `column`."""
    noise = hashed_noise(key, column, len(weights)) * 2.0**-shift
    return (weights + noise).astype(np.float32)
