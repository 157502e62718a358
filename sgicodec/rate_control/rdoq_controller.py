"""RDOQ on the way to a rate target: what it adds to a fit, what its passes cost, λ from pass to pass."""

from __future__ import annotations

import math

from sgicodec.rate_control.target import Measured, RateTarget

__all__ = ["MAX_EXTRA_PASSES", "RdoqController", "StreamEstimate", "fit_target"]

RDOQ_BYTES_FRACTION, RDOQ_GAIN_DB = 0.943, 0.45
"""Part of the bytes of a fit that RDOQ leaves, and what it adds to the PSNR. Medians over photographs, at three numbers
of steps and three λ, are 0.92 to 0.95 and 0.25 to 0.81 dB; one number of each does as well.
"""
TRUSTED_GAIN_FRACTION = 0.5
"""Part of the gain on which a fit relies: RDOQ drops superfluous seeds, but adds none."""
MAX_EXTRA_PASSES = 5
"""Passes beyond those of an encode without a target."""
RISE_GAIN, RISE_GROWTH, FALL_GAIN = 1.0, 1.5, 2.5
"""Multiples of the rate error by which λ moves between two passes: up; how much further each time that it must rise
again; down. Passes drop seeds and add none, so that a smaller λ does less than a larger one.
"""
MOVE_MAX_OCTAVES = 1.0


def fit_target(target: RateTarget) -> RateTarget:
    """Where a fit has to end so that RDOQ ends at the target."""
    if target.bytes is not None:
        return RateTarget(bytes=target.bytes / RDOQ_BYTES_FRACTION)
    return RateTarget(psnr=(target.psnr or 0.0) - TRUSTED_GAIN_FRACTION * RDOQ_GAIN_DB)


class RdoqController:
    """λ of the next pass."""

    def __init__(self, target: RateTarget, lmbda: float) -> None:
        self.target, self.lmbda = target, lmbda
        self._passes, self._rise = 0, RISE_GAIN

    def update(self, measured: Measured) -> None:
        """Moves λ by what the stream of the last pass is. The first pass says little: scales are not fitted yet, and
        seeds that do not pay are still there.
        """
        self._passes += 1
        if self._passes == 1:
            return
        error = self.target.rate_error(measured)
        moved = (FALL_GAIN if error < 0 else self._rise) * error
        self.lmbda *= 2.0 ** max(-MOVE_MAX_OCTAVES, min(MOVE_MAX_OCTAVES, moved))
        self._rise = RISE_GAIN if error < 0 else RISE_GROWTH * self._rise


class StreamEstimate:
    """Estimates the stream of a pass from the bits and the PSNR that RDOQ knows, which count neither the container nor
    the rounding of samples; `correct` learns the difference from a measured stream.
    """

    def __init__(self) -> None:
        self._bytes, self._decibels = 0.0, 0.0

    def of(self, bits: float, psnr: float) -> Measured:
        """The stream of a pass with these bits and this PSNR."""
        return Measured(bits / 8 + self._bytes, psnr + self._decibels)

    def correct(self, bits: float, psnr: float, measured: Measured) -> None:
        """Learns that the stream of a pass with these bits and this PSNR is `measured`."""
        self._bytes = measured.bytes - bits / 8
        if math.isfinite(measured.psnr):
            self._decibels = measured.psnr - psnr
