"""The noise that native/fit/noise.hpp draws, in numpy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.fit.noise_key import NoiseKey

__all__ = ["hashed_noise"]


def hashed_noise(key: NoiseKey, column: int, seeds: int) -> NDArray[np.float64]:
    """Uniform in (−½, ½), a hash of key, column and seed [seeds]: "lowbias32" in 64-bit arithmetic."""
    mask = 0xFFFFFFFF
    x = (np.arange(seeds, dtype=np.uint64) * 0x9E3779B9) & mask
    x ^= np.uint64((key.key + column * 0x85EBCA6B) & mask)
    x = ((x ^ (x >> np.uint64(16))) * np.uint64(0x7FEB352D)) & mask
    x = ((x ^ (x >> np.uint64(15))) * np.uint64(0x846CA68B)) & mask
    x ^= x >> np.uint64(16)
    noise = ((x >> np.uint64(8)).astype(np.float64) + 0.5) / 2**24 - 0.5
    return -noise if key.negative else noise
