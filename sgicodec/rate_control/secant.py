"""Secant step: by how much to move the λ of how many tiles, when all of them together missed a target."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sgicodec.rate_control.tile_passes import spread_over

__all__ = ["COARSER_TEXTURE", "FINER_TEXTURE", "REFIT", "SEARCH", "Correction"]

MIN_TILES = 4
MIN_STEP_OCTAVES = 1e-3
"""λ that differ by less say nothing of the slope."""
MIN_FIRST_STEP = 0.2
"""Part of `least` by which λ of all tiles moves at least, as long as nothing was tried."""


@dataclass(frozen=True)
class Correction:
    """A kind of pass after the fits. direction: of λ; slope: octaves of bytes or error that an octave of λ moves;
    least, most: octaves that λ moves; overshoot: factor on what seems to be needed of some tiles; margin:
    octaves of bytes or error by which later passes go beyond it.
    """

    name: str
    direction: int
    slope: float
    least: float
    most: float
    overshoot: float
    margin: float = 0.0

    def next(
        self, left: float, shares: dict[int, float], fresh: Sequence[int], tried: Sequence[tuple[float, float]]
    ) -> tuple[float, list[int]]:
        """Octaves by which to move the λ of which tiles. left: error of the best allocation. shares: what each tile has
        of the total. fresh: tiles that were not corrected yet, of which some suffice where the error is small. tried:
        octaves, and the error if all tiles moved by them.
        """
        if fresh and left * self.direction > 0:
            return self._of_fresh(left, shares, fresh)
        last, slope = tried[-1][0] if tried else 0.0, self.slope
        if len(tried) > 1 and abs(last - tried[-2][0]) > MIN_STEP_OCTAVES:
            slope = min(max((tried[-2][1] - tried[-1][1]) / (last - tried[-2][0]), 0.3 * slope), 3 * slope)
        error = tried[-1][1] if tried else left
        beyond = math.copysign(self.margin, error) if tried else 0.0
        wanted = self.direction * (last + (error + beyond) / slope)
        lowest = (
            -self.least if tried else MIN_FIRST_STEP * self.least
        )  # all tiles may overshoot: then back, past the fits
        return self.direction * min(max(wanted, lowest), self.most), list(shares)

    def _of_fresh(self, left: float, shares: dict[int, float], fresh: Sequence[int]) -> tuple[float, list[int]]:
        part = sum(shares[number] for number in fresh) / max(sum(shares.values()), 1e-9)
        wanted = self.overshoot * abs(left) / self.slope / max(part, 1e-3)
        count = max(MIN_TILES, math.ceil(len(fresh) * wanted / self.least))
        numbers = list(fresh)
        if count < len(numbers):
            numbers = [numbers[at] for at in spread_over(np.array([shares[number] for number in fresh]), count)]
        return self.direction * min(max(wanted, self.least), self.most), numbers


SEARCH = Correction("search", 1, 0.2, 0.35, 4.0, 1.3)
"""RDOQ of what is coded: fast, but it drops seeds and adds none."""
REFIT = Correction("again", -1, 0.6, 0.5, 2.0, 1.1)
"""Another fit: slow, but it adds seeds."""
COARSER_TEXTURE = Correction("search", 1, 0.35, 0.1, 4.0, 1.3, 0.01)
FINER_TEXTURE = replace(COARSER_TEXTURE, direction=-1)
"""Texture of another step over the seeds that are coded: fast, and it goes both ways."""
