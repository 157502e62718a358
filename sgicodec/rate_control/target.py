"""What an encode is to end at, a size or a PSNR, and how far what was measured is from it."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["LMBDA_RANGE", "Measured", "RateTarget"]


@dataclass(frozen=True)
class Measured:
    """What a stream would be: bytes on disk and PSNR in dB of the decoded samples."""

    bytes: float
    psnr: float


@dataclass(frozen=True)
class RateTarget:
    """Where a fit is to end: at a size in bytes (never above it), or at a PSNR in dB."""

    bytes: float | None = None
    psnr: float | None = None

    def rate_error(self, measured: Measured) -> float:
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

    def miss_message(self, measured: Measured) -> str:
        """What to say where the best that was found misses the goal."""
        if self.bytes is not None:
            return f"no stream of at most {self.bytes:.0f} bytes was found; the smallest has {measured.bytes:.0f}"
        return f"no stream of {self.psnr:g} dB was found; the best reaches {measured.psnr:.2f} dB"


_AIM, _FULL, _TOLERANCE = 0.99, 0.97, 0.1
_BYTES_PER_OCTAVE = 0.65
"""log2 of the bytes that an octave of λ takes or gives, on photographs between 0.1 and 1 bpp."""
_DECIBELS_PER_OCTAVE = 1.5
_PERFECT = 200.0
"""dB that stand for no error at all."""
LMBDA_RANGE = 1e-6, 4.0
"""Where goals are looked for."""
