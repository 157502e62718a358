"""How far to move the λ of how many tiles, when all of them together missed a goal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sgicodec.rate_control.tile_rd_model import spread

__all__ = ["FIT", "SEARCH", "Correction"]


@dataclass(frozen=True)
class Correction:
    """A kind of round after the fits. direction: of λ; slope: octaves of bytes or error that an octave of λ moves;
    least, most: octaves that λ moves; more: how much further it goes than it seems to need.
    """

    name: str
    direction: int
    slope: float
    least: float
    most: float
    more: float

    def next(
        self, left: float, shares: dict[int, float], fresh: Sequence[int], tried: Sequence[tuple[float, float]]
    ) -> tuple[float, list[int]]:
        """By how many octaves to move the λ of which tiles. left: what the best choice still needs. shares: what each
        tile has of the total. fresh: tiles that were not corrected yet, of which some do where little is left. tried:
        octaves, and what they would leave to need if all tiles took them.
        """
        if fresh and left * self.direction > 0:
            part = sum(shares[number] for number in fresh) / max(sum(shares.values()), 1e-9)
            wanted = self.more * abs(left) / self.slope / max(part, 1e-3)
            count = max(_FEW, math.ceil(len(fresh) * wanted / self.least))
            numbers = list(fresh)
            if count < len(numbers):
                numbers = [numbers[at] for at in spread(np.array([shares[number] for number in fresh]), count)]
            return self.direction * min(max(wanted, self.least), self.most), numbers
        last, slope = tried[-1][0] if tried else 0.0, self.slope
        if len(tried) > 1 and abs(last - tried[-2][0]) > 1e-3:
            slope = min(max((tried[-2][1] - tried[-1][1]) / (last - tried[-2][0]), 0.3 * slope), 3 * slope)
        wanted = self.direction * (last + (tried[-1][1] if tried else left) / slope)
        return self.direction * min(max(wanted, 0.2 * self.least), self.most), list(shares)


_FEW = 4
SEARCH = Correction("search", 1, 0.2, 0.35, 4.0, 1.3)
"""Cheap, but it drops seeds and adds none."""
FIT = Correction("again", -1, 0.6, 0.5, 2.0, 1.1)
"""Dear, but it adds seeds."""
