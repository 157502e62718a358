"""The noise that stands for quantisation while a fit trains: what it is a hash of, and the same hash in numpy."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class NoiseKey(NamedTuple):
    """What noise is a hash of, in 32 bits; `negative` for that noise with its signs turned."""

    key: int
    negative: bool

    @classmethod
    def of(cls, seed: int, number: int) -> NoiseKey:
        """That of step `number`: steps go in pairs of opposite noise, whose errors of first order cancel."""
        pair, second = divmod(number, 2)
        return cls((seed * 0x9E3779B1 + pair * 0x85EBCA77) & 0xFFFFFFFF, bool(second))


def hashed_noise(key: NoiseKey, column: int, seeds: int) -> NDArray[np.float64]:
    """Uniform in (−½, ½), a hash of key, column and seed [seeds], as native/fit/noise.hpp draws it: "lowbias32"."""
    x = np.arange(seeds, dtype=np.uint32) * np.uint32(0x9E3779B9)
    x ^= np.uint32((key.key + column * 0x85EBCA6B) & 0xFFFFFFFF)
    x = (x ^ (x >> np.uint32(16))) * np.uint32(0x7FEB352D)
    x = (x ^ (x >> np.uint32(15))) * np.uint32(0x846CA68B)
    x ^= x >> np.uint32(16)
    noise = ((x >> np.uint32(8)).astype(np.float64) + 0.5) / 2**24 - 0.5
    return -noise if key.negative else noise
