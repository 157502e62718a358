"""Ends a fit at a size or a quality: moves λ while it runs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sgicodec.fit.course import DONE, POSITION_BITS, course
from sgicodec.model.layout import ROOT_LOG, cell_sums, leaf_sums

if TYPE_CHECKING:
    from sgicodec.fit.settings import FitSettings

__all__ = [
    "DEARER",
    "LMBDA_RANGE",
    "STREAM_BYTES",
    "Foretold",
    "Goal",
    "Measured",
    "Steering",
    "bisected",
    "first_lmbda",
]


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
        return (min(measured.psnr, _PERFECT) - (self.psnr or 0.0)) / _DECIBELS_PER_OCTAVE

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

    def regret(self, measured: Measured) -> str:
        """What to say where the best that was found misses the goal."""
        if self.bytes is not None:
            return f"no stream of at most {self.bytes:.0f} bytes was found; the smallest has {measured.bytes:.0f}"
        return f"no stream of {self.psnr:g} dB was found; the best reaches {measured.psnr:.2f} dB"


_AIM, _FULL, _TOLERANCE = 0.99, 0.97, 0.1
_BYTES_PER_OCTAVE = 0.65
"""log2 of the bytes that an octave of λ takes or gives, on photographs between 0.1 and 1 bpp."""
_DECIBELS_PER_OCTAVE = 1.5
_MARGIN = 0.1
_PERFECT = 200.0
"""dB that stand for no error at all."""
LMBDA_RANGE = 1e-6, 4.0
"""Where goals are looked for."""


class Steering:
    """λ as a function of how the fit goes: two leaps early on, then an integral controller, on the outcome that the
    state so far foretells.

    `overhead` is what the stream holds beside seeds, in bytes. `leaps` is False where λ is known to be nearly right.
    """

    checks = (0.3, 0.6, 0.9)
    """Fractions of the noise phase after which a real stream corrects the forecast."""

    def __init__(self, goal: Goal, lmbda: float, overhead: float, leaps: bool = True) -> None:
        # A little better than asked: at the end, finer steps buy less than coarser ones cost.
        self.goal = goal if goal.psnr is None else Goal(psnr=goal.psnr + _MARGIN)
        self.lmbda, self.overhead = lmbda, overhead
        self._excess: float | None = None
        self._correction = 0.0
        self._leaps, self._leapt = leaps, not leaps

    def steer(self, done: float, steps: int, bits: float, seeds: int, psnr: float) -> float:
        """λ after a step of a fit of so many, from the fraction that lies behind, bits of the seeds' attributes, their
        number, and PSNR under noise.
        """
        if done < _LEAP or (self._leapt and done < _SETTLED):
            return self.lmbda
        excess = self.goal.excess(self._forecast(done, steps, bits + POSITION_BITS * seeds, psnr))
        self._excess = excess if self._excess is None else 0.8 * self._excess + 0.2 * excess
        if not self._leapt:
            self._leapt = True
            self._move(_LEAP_GAIN * self._excess, 2.0)
            self._excess = None
        else:
            late = min(1.0, (1.0 - done) / _FADE)  # λ then hardly changes the outcome
            gain = late * min(_MOST_GAIN, _GAIN_STEPS / steps)
            self._move(gain * (self._excess + self._correction), 0.5)
        return self.lmbda

    def correct(self, done: float, steps: int, measured: Measured) -> None:
        """Takes in what a real stream of this moment is."""
        if self._excess is None:
            return
        (end, _), (now, lift) = (course(at, steps, self.lmbda) for at in (1.0, done))
        size = max(measured.bytes - self.overhead, 1.0) * end / now + self.overhead
        # Until noise is better than what is decoded, both have the same PSNR.
        self._correction = self.goal.excess(Measured(size, measured.psnr - min(0.0, lift))) - self._excess

    def foresee(
        self, energy: NDArray[np.float32], bits: NDArray[np.float32], price: float, psnr: float, steps: int
    ) -> float:
        """Moves λ before seeds are dropped for the first time, by what would be left of a size or by the PSNR under
        noise, and returns the λ to drop them at.

        energy, bits [N] of every seed; a seed is dropped whose energy is below price · λ.
        """
        if not self._leaps:
            return self.lmbda
        kept = bits[energy > price * self.lmbda]
        (_, lift), (ratio, _) = (course(done, steps, self.lmbda) for done in DONE[:2])
        size = float(np.sum(kept + POSITION_BITS, dtype=np.float64)) / 8 / ratio + self.overhead
        excess = self.goal.excess(Measured(size, psnr - lift))
        if self.goal.bytes is not None:
            self._move(_SIZE_FORESIGHT * excess, 2.0)
            return self.lmbda
        self._move(_PSNR_FORESIGHT * excess, 2.0)
        return 0.75 * self.lmbda  # texture never regains what is dropped too soon, and the next time is near

    def _forecast(self, done: float, steps: int, bits: float, psnr: float) -> Measured:
        ratio, lift = course(done, steps, self.lmbda)
        return Measured(bits / 8 / ratio + self.overhead, psnr - lift)

    def _move(self, octaves: float, most: float) -> None:
        moved = self.lmbda * 2.0 ** max(-most, min(most, octaves))
        self.lmbda = max(LMBDA_RANGE[0], min(LMBDA_RANGE[1], moved))


_LEAP, _SETTLED, _FADE = 0.29, 0.35, 0.4
"""Fractions of a fit: seeds were dropped once, what followed has settled; from 1 − 0.4 on, λ moves less."""
_MOST_GAIN, _GAIN_STEPS = 0.08, 24.0
"""Part of the excess that λ makes up in a step from then on, at most and in a fit of one step."""
_SIZE_FORESIGHT, _PSNR_FORESIGHT, _LEAP_GAIN = 0.4, 0.6, 0.8
"""Parts of the excess that λ makes up at once, before and after seeds are dropped for the first time."""


def first_lmbda(goal: Goal, detail: NDArray[np.float32], settings: FitSettings, extra: float = 0.0) -> float:
    """Where to begin: λ at which the seeds that a fit of `detail` [C, H, W] starts with foretell the goal. `extra`
    bytes come on top.

    The forecast knows what the search for symbols will gain.
    """
    foretold = Foretold(detail, settings)

    def must_rise(lmbda: float) -> bool:
        size, error = foretold.at(lmbda)
        return goal.excess(Measured(size + extra, -10 * math.log10(error))) > 0

    return bisected(must_rise, 8)


def bisected(must_rise: Callable[[float], bool], halvings: int) -> float:
    """λ in LMBDA_RANGE below which `must_rise` holds, by halving octaves so many times."""
    low, high = (math.log2(limit) for limit in LMBDA_RANGE)
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if must_rise(2.0**middle) else (low, middle)
    return float(2.0 ** (0.5 * (low + high)))


DEARER = 4.0
"""Price of a seed at which forecasts of error count seeds once more."""
_FLAT = 1e-9
"""Squared deviation that stands for none."""
STREAM_BYTES = 200.0
"""Of a stream without seeds, about."""


class Foretold:
    """What a fit of `detail` [C, H, W], a picture less its base layer, will come to at any λ.

    Forecasts are products of powers of λ, of the number of seeds and of what deviates within their cells, fitted to
    photographs; that of the error also sees both at four times the price of a seed: how quickly more seeds become
    worth their bits tells fine texture from edges (docs/research.md, "Forecasts").
    """

    def __init__(self, detail: NDArray[np.float32], settings: FitSettings) -> None:
        self.settings, self.channels, self.pixels = settings, len(detail), detail[0].size
        self._sums = cell_sums(detail, ROOT_LOG)

    def at(self, lmbda: float) -> tuple[float, float]:
        """Bytes of the stream and mean squared error of a sample in 0..1."""
        (count, deviation), (fewer, larger) = self.seeds(lmbda), self.seeds(lmbda, DEARER)
        size = STREAM_BYTES + self.pixels * 0.5 * lmbda**-0.33 * count**0.77 * deviation**0.36
        error = 2.8 * lmbda**0.918 * count**2.85 * fewer**-1.91 * deviation**2.43 * larger**-2.39
        return size, error / self.channels

    def seeds(self, lmbda: float, price: float = 1.0) -> tuple[float, float]:
        """For each pixel, their number and what deviates within their cells, where one costs `price` times as much."""
        count, deviation = leaf_sums(self._sums, price * self.settings.split * lmbda * self.settings.seed_bits)
        return count / self.pixels, max(deviation / self.pixels, _FLAT)
