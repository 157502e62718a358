"""Ends a fit at a size or a quality: moves λ while it runs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.rate_control.convergence import DONE, POSITION_BITS, course
from sgicodec.rate_control.target import LMBDA_RANGE, Measured, RateTarget

__all__ = ["LambdaController"]


class LambdaController:
    """λ as a function of how the fit goes: two leaps early on, then an integral controller, on the outcome that the
    state so far foretells.

    `overhead` is what the stream holds beside seeds, in bytes. `leaps` is False where λ is known to be nearly right.
    """

    checks = (0.3, 0.6, 0.9)
    """Fractions of the noise phase after which a real stream corrects the forecast."""

    def __init__(self, goal: RateTarget, lmbda: float, overhead: float, leaps: bool = True) -> None:
        # A little better than asked: at the end, finer steps buy less than coarser ones cost.
        self.goal = goal if goal.psnr is None else RateTarget(psnr=goal.psnr + _MARGIN)
        self.lmbda, self.overhead = lmbda, overhead
        self._excess: float | None = None
        self._correction = 0.0
        self._leaps, self._leapt = leaps, not leaps

    def update(self, done: float, steps: int, bits: float, seeds: int, psnr: float) -> float:
        """λ after a step of a fit of so many, from the fraction that lies behind, bits of the seeds' attributes, their
        number, and PSNR under noise.
        """
        if done < _LEAP or (self._leapt and done < _SETTLED):
            return self.lmbda
        excess = self.goal.rate_error(self._forecast(done, steps, bits + POSITION_BITS * seeds, psnr))
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
        self._correction = self.goal.rate_error(Measured(size, measured.psnr - min(0.0, lift))) - self._excess

    def update_before_pruning(
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
        excess = self.goal.rate_error(Measured(size, psnr - lift))
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
_MARGIN = 0.1
"""dB that a fit ends above the PSNR that was asked for."""
