"""Ends a fit at a size or a quality: moves λ while it runs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sgicodec.model.layout import ROOT_LOG, cell_sums, count_leaves

if TYPE_CHECKING:
    from sgicodec.fit.settings import FitSettings

__all__ = ["Goal", "Measured", "Steering", "first_lmbda"]


@dataclass(frozen=True)
class Measured:
    """What a stream would be: bytes on disk and PSNR in dB of the decoded samples."""

    bytes: float
    psnr: float


@dataclass(frozen=True)
class Goal:
    """Where a fit is to end: at a size in bytes (never above it), or at a PSNR in dB."""

    bytes: float | None = None
    psnr: float | None = None

    def excess(self, measured: Measured) -> float:
        """How many octaves λ should rise, as far as this can be told: positive where more is spent than was asked."""
        if self.bytes is not None:
            return math.log2(max(measured.bytes, 1.0) / (_AIM * self.bytes)) / _BYTES_PER_OCTAVE
        return (measured.psnr - (self.psnr or 0.0)) / _DECIBELS_PER_OCTAVE

    def is_met(self, measured: Measured) -> bool:
        """Size: at most the goal, and within 3 % of it. PSNR: within 0.1 dB."""
        if self.bytes is not None:
            return _FULL * self.bytes <= measured.bytes <= self.bytes
        return abs(measured.psnr - (self.psnr or 0.0)) <= _TOLERANCE

    def is_missed(self, measured: Measured) -> bool:
        """Larger than was allowed, or worse than was asked."""
        if self.bytes is not None:
            return measured.bytes > self.bytes
        return measured.psnr < (self.psnr or 0.0) - _TOLERANCE


_AIM, _FULL, _TOLERANCE = 0.99, 0.97, 0.1
_BYTES_PER_OCTAVE = 0.65
"""log2 of the bytes that an octave of λ takes or gives, on photographs between 0.1 and 1 bpp."""
_DECIBELS_PER_OCTAVE = 1.5
_LMBDA_RANGE = 1e-6, 4.0
_POSITION_BITS = 4.0
"""Of a seed, about."""


class Steering:
    """λ as a function of how the fit goes: an integral controller on the outcome that the state so far foretells.

    `overhead` is what the stream holds beside seeds, in bytes.
    """

    checks = (0.3, 0.6, 0.9)
    """Fractions of the noise phase after which a real stream corrects the forecast."""

    def __init__(self, goal: Goal, lmbda: float, overhead: float) -> None:
        self.goal, self.lmbda, self.overhead = goal, lmbda, overhead
        self._excess: float | None = None
        self._correction = 0.0

    def observe(self, done: float, steps: int, bits: float, seeds: int, psnr: float) -> None:
        """Takes in the state after a step of a fit of so many: the fraction that lies behind, bits of the seeds'
        attributes, their number, PSNR under noise.
        """
        ratio, lift = _course(done, steps)
        size = (bits + _POSITION_BITS * seeds) / 8 / ratio + self.overhead
        excess = self.goal.excess(Measured(size, psnr - lift))
        self._excess = excess if self._excess is None else 0.8 * self._excess + 0.2 * excess

    def correct(self, measured: Measured) -> None:
        """Takes in what a real stream of this moment is."""
        if self._excess is not None:
            self._correction = self.goal.excess(measured) - self._excess

    def steer(self, gain: float) -> float:
        """Moves λ by a part of the excess and returns it."""
        if self._excess is not None:
            octaves = max(-0.5, min(0.5, gain * (self._excess + self._correction)))
            self.lmbda = max(_LMBDA_RANGE[0], min(_LMBDA_RANGE[1], self.lmbda * 2.0**octaves))
        return self.lmbda

    def foresee(self, energy: NDArray[np.float32], bits: NDArray[np.float32], price: float) -> float:
        """λ before seeds are dropped for the first time, from what would be left at a size that is asked for.

        energy, bits [N] of every seed; a seed is dropped whose energy is below price · λ.
        """
        if self.goal.bytes is None:
            return self.steer(1.0)
        order = np.argsort(-energy)
        size = np.cumsum(bits[order] + _POSITION_BITS, dtype=np.float64) / 8 / _FIRST_DROP + self.overhead
        kept = int(np.searchsorted(size, _AIM * self.goal.bytes))
        if 0 < kept < len(order):
            self.lmbda = max(_LMBDA_RANGE[0], min(_LMBDA_RANGE[1], float(energy[order[kept]]) / price))
        self._excess = None
        return self.lmbda


_FIRST_DROP = 1.3
"""Bytes after seeds are dropped for the first time, over those of the final stream."""

# How the state of a fit at constant λ relates to its outcome, after a fraction of 350 and of 1,000 steps: estimated
# bytes over the stream's, and PSNR under noise less the decoded picture's. Means over photographs.
_DONE = (0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0)
_RATIO = (
    (1.35, 1.22, 1.18, 1.09, 1.04, 1.02, 1.01, 0.99, 0.985, 0.985),
    (1.25, 1.09, 1.06, 1.03, 1.015, 1.01, 1.005, 0.99, 0.985, 0.985),
)
_LIFT = (
    (-2.5, -1.9, -1.25, -0.98, -0.82, -0.72, -0.6, -0.2, 0.05, 0.1),
    (-1.9, -0.9, -0.63, -0.54, -0.48, -0.45, -0.4, -0.06, 0.1, 0.18),
)


def _course(done: float, steps: int) -> tuple[float, float]:
    """Ratio of bytes and difference of PSNR to expect when a fraction of so many steps lies behind."""
    part = min(1.0, max(0.0, math.log(steps / 350) / math.log(1000 / 350)))
    few, many = ([float(np.interp(done, _DONE, table[i])) for table in (_RATIO, _LIFT)] for i in (0, 1))
    return few[0] + part * (many[0] - few[0]), few[1] + part * (many[1] - few[1])


def first_lmbda(goal: Goal, detail: NDArray[np.float32], settings: FitSettings) -> float:
    """Where to begin: λ at which the seeds that a fit of `detail` [C, H, W] starts with foretell the goal.

    A stream has about one byte for each of them, and its squared error is about 1.7 λ times its bits.
    """
    sums = cell_sums(detail, ROOT_LOG)
    low, high = (math.log2(limit) for limit in _LMBDA_RANGE)
    for _ in range(8):
        middle = 0.5 * (low + high)
        lmbda = 2.0**middle
        size = 0.95 * count_leaves(sums, settings.split * lmbda * settings.seed_bits)
        quality = -10 * math.log10(1.7 * lmbda * 8 * size / detail.size)
        low, high = (middle, high) if goal.excess(Measured(size, quality)) > 0 else (low, middle)
    return float(2.0 ** (0.5 * (low + high)))
