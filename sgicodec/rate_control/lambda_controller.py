"""λ controller: moves λ during a fit, so that the fit ends at a size or a PSNR."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.rate_control.convergence import DONE, expected
from sgicodec.rate_control.side_information import SEED_POSITION_BITS
from sgicodec.rate_control.target import LMBDA_MAX, LMBDA_MIN, Measured, RateTarget

__all__ = ["LambdaController"]

PSNR_MARGIN_DB = 0.1
"""How far above its PSNR a fit ends: afterwards finer steps buy less than coarser ones cost."""
JUMP_AT, INTEGRAL_FROM = 0.29, 0.35
"""Fractions of a fit: the first pruning is done; what followed it has settled."""
FADE = 0.4
"""Last fraction of a fit over which the gain falls to zero, since λ then hardly changes the outcome."""
INTEGRAL_GAIN_MAX, INTEGRAL_GAIN_STEPS = 0.08, 24.0
"""Part of the rate error by which λ moves in a step: at most, and times the number of steps."""
SIZE_GAIN_BEFORE_PRUNING, PSNR_GAIN_BEFORE_PRUNING, JUMP_GAIN = 0.4, 0.6, 0.8
"""Parts of the rate error by which λ moves at once, before and after the first pruning."""
PSNR_PRUNING_FRACTION = 0.75
"""Part of λ at which the first pruning drops seeds for a PSNR: texture never regains what is dropped too early."""
JUMP_MAX_OCTAVES, STEP_MAX_OCTAVES = 2.0, 0.5


class LambdaController:
    """λ as a function of the state of a fit: a move before the first pruning, an initial jump after it, then an
    integral controller on the rate error of the predicted outcome.

    `overhead`: bytes of the stream beside its seeds. `jumps` is False where λ is known to be nearly right.
    """

    def __init__(self, target: RateTarget, lmbda: float, overhead: float, jumps: bool = True) -> None:
        self.target = target if target.psnr is None else RateTarget(psnr=target.psnr + PSNR_MARGIN_DB)
        self.lmbda, self.overhead = lmbda, overhead
        self._jumps, self._jumped = jumps, not jumps

    def update(self, done: float, steps: int, bits: float, seeds: int, psnr: float) -> float:
        """λ after a step of a fit of `steps`, from the fraction that is done, bits of the seeds' attributes, their
        number, and PSNR under noise.
        """
        if done < JUMP_AT or (self._jumped and done < INTEGRAL_FROM):
            return self.lmbda
        ratio, offset = expected(done, steps, self.lmbda)
        size = (bits + SEED_POSITION_BITS * seeds) / 8 / ratio + self.overhead
        error = self.target.rate_error(Measured(size, psnr - offset))
        if not self._jumped:
            self._jumped = True
            self._move(JUMP_GAIN * error, JUMP_MAX_OCTAVES)
        else:
            gain = min(1.0, (1.0 - done) / FADE) * min(INTEGRAL_GAIN_MAX, INTEGRAL_GAIN_STEPS / steps)
            self._move(gain * error, STEP_MAX_OCTAVES)
        return self.lmbda

    def update_before_pruning(
        self, energy: NDArray[np.float32], bits: NDArray[np.float32], price: float, psnr: float, steps: int
    ) -> float:
        """Moves λ before the first pruning, by the size that would remain or by the PSNR under noise, and returns the
        λ to prune at.

        energy, bits [N] of every seed; a seed is dropped whose energy is below price · λ.
        """
        if not self._jumps:
            return self.lmbda
        kept = bits[energy > price * self.lmbda]
        (_, offset), (ratio, _) = (expected(done, steps, self.lmbda) for done in DONE[:2])
        size = float(np.sum(kept + SEED_POSITION_BITS, dtype=np.float64)) / 8 / ratio + self.overhead
        error = self.target.rate_error(Measured(size, psnr - offset))
        if self.target.bytes is not None:
            self._move(SIZE_GAIN_BEFORE_PRUNING * error, JUMP_MAX_OCTAVES)
            return self.lmbda
        self._move(PSNR_GAIN_BEFORE_PRUNING * error, JUMP_MAX_OCTAVES)
        return PSNR_PRUNING_FRACTION * self.lmbda

    def _move(self, octaves: float, most: float) -> None:
        moved = self.lmbda * 2.0 ** max(-most, min(most, octaves))
        self.lmbda = max(LMBDA_MIN, min(LMBDA_MAX, moved))
