"""The rate target of an encode, a size or a PSNR, and how far a measured stream is from it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["LMBDA_MAX", "LMBDA_MIN", "Measured", "RateTarget"]

LMBDA_MIN, LMBDA_MAX = 1e-6, 4.0
"""Range of λ in which rate control searches."""
SIZE_MIN_FRACTION = 0.97
"""Least part of the size that was asked for."""
SIZE_AIM_FRACTION = 0.99
"""Part of the size at which the rate error is zero: in the upper half of what is allowed."""
PSNR_TOLERANCE_DB = 0.1
"""How far a PSNR may lie from the one that was asked for."""
SIZE_OCTAVES_PER_LMBDA_OCTAVE = 0.65
"""log2 of the bytes that an octave of λ takes or gives, on photographs between 0.1 and 1 bpp."""
PSNR_DB_PER_LMBDA_OCTAVE = 1.5
SCORE_TOLERANCE = 1.0
"""How far a SSIMULACRA 2 score may lie from the one that was asked for."""
SCORE_PER_LMBDA_OCTAVE = 8.0
"""Of photographs between scores of 40 and 80; below, an octave takes more."""
SCORE_LMBDA = 0.5 * 2.0 ** (-49 / 8), 60.0
"""A λ, and the score that photographs have there: where the search for a score begins."""
PSNR_MAX_DB = 200.0
"""Stands for the infinite PSNR of a picture without error."""


@dataclass(frozen=True)
class Measured:
    """Bytes of a stream on disk; PSNR in dB and SSIMULACRA 2 score of its decoded samples, where they are asked for."""

    bytes: float
    psnr: float
    score: float = math.nan


@dataclass(frozen=True)
class RateTarget:
    """A size in bytes that the stream must not exceed, or a PSNR in dB or a SSIMULACRA 2 score that it must have."""

    bytes: float | None = None
    psnr: float | None = None
    score: float | None = None

    def rate_error(self, measured: Measured) -> float:
        """Estimate of the octaves by which λ should rise: positive where the stream spends more than was asked for."""
        if self.bytes is not None:
            octaves = math.log2(max(measured.bytes, 1.0) / (SIZE_AIM_FRACTION * self.bytes))
            return octaves / SIZE_OCTAVES_PER_LMBDA_OCTAVE
        if self.score is not None:
            return (measured.score - self.score) / SCORE_PER_LMBDA_OCTAVE
        return (min(measured.psnr, PSNR_MAX_DB) - (self.psnr or 0.0)) / PSNR_DB_PER_LMBDA_OCTAVE

    def is_met(self, measured: Measured) -> bool:
        """Size: at most the target, and within 3 % of it. PSNR: within 0.1 dB. Score: within 1."""
        if self.bytes is not None:
            return SIZE_MIN_FRACTION * self.bytes <= measured.bytes <= self.bytes
        if self.score is not None:
            return abs(measured.score - self.score) <= SCORE_TOLERANCE
        return abs(measured.psnr - (self.psnr or 0.0)) <= PSNR_TOLERANCE_DB

    def is_missed(self, measured: Measured) -> bool:
        """Whether the stream is larger than was allowed, or worse than was asked for."""
        if self.bytes is not None:
            return measured.bytes > self.bytes
        if self.score is not None:
            return measured.score < self.score - SCORE_TOLERANCE
        return measured.psnr < (self.psnr or 0.0) - PSNR_TOLERANCE_DB

    def nearest(self, streams: Sequence[Measured]) -> int:
        """Index of the stream with the least rate error, among those that do not miss the target if there are any."""
        sound = [index for index, measured in enumerate(streams) if not self.is_missed(measured)]
        return min(sound or range(len(streams)), key=lambda index: abs(self.rate_error(streams[index])))

    def best(self, streams: Sequence[Measured]) -> int:
        """Index of the stream with the fewest bytes for what it shows, among those that meet a PSNR or a score if there
        are any; else of the nearest.
        """
        met = [index for index, measured in enumerate(streams) if self.bytes is None and self.is_met(measured)]
        if not met:
            return self.nearest(streams)

        def cost(index: int) -> float:
            octaves = SIZE_OCTAVES_PER_LMBDA_OCTAVE * self.rate_error(streams[index])
            return math.log2(max(streams[index].bytes, 1.0)) - octaves

        return min(met, key=cost)

    def miss_message(self, measured: Measured) -> str:
        """What to report where the best stream misses the target."""
        if self.bytes is not None:
            return f"no stream of at most {self.bytes:.0f} bytes was found; the smallest has {measured.bytes:.0f}"
        if self.score is not None:
            return f"no stream of SSIMULACRA 2 {self.score:g} was found; the best reaches {measured.score:.1f}"
        return f"no stream of {self.psnr:g} dB was found; the best reaches {measured.psnr:.2f} dB"
