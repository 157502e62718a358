"""The quality at which a peer has the PSNR of sgi: found on a sample of the picture, corrected on the whole of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from benchmarks.large.notes import Trip

__all__ = ["TOLERANCE", "Matched", "Probes", "match", "nearest_rung"]

TOLERANCE = 0.1
"""dB that a peer may be away from sgi."""

_MOST_WHOLE = 3
"""Encodes of the whole picture on the way there."""


@dataclass
class Probes:
    """Trips by rung, each made once."""

    make: Callable[[int], Trip]
    made: dict[int, Trip] = field(default_factory=dict)

    def __call__(self, rung: int) -> Trip:
        if rung not in self.made:
            self.made[rung] = self.make(rung)
        return self.made[rung]


@dataclass(frozen=True)
class Matched:
    """The trip that came nearest, and its bytes brought to the PSNR that was asked for along the codec's own curve."""

    trip: Trip
    equal_bytes: float


def nearest_rung(psnr_at: Callable[[int], float], target: float, rungs: int) -> int:
    """The rung of 0 … rungs − 1 whose PSNR is nearest to `target`, by bisection."""
    low, high = 0, rungs - 1
    while low < high:
        middle = (low + high) // 2
        if psnr_at(middle) < target:
            low = middle + 1
        else:
            high = middle
    below = max(low - 1, 0)
    return min((low, below), key=lambda rung: abs(psnr_at(rung) - target))


def match(target: float, rungs: int, probe: Probes, whole: Probes) -> Matched:
    """Codes the whole picture at the rung that the sample proposes, and again at another one if the two differ."""
    offset, tried = 0.0, list[Trip]()
    for _ in range(_MOST_WHOLE):
        shift = offset
        rung = nearest_rung(lambda rung: probe(rung).psnr + shift, target, rungs)  # noqa: B023 (called at once)
        trip = whole(rung)
        if trip in tried:
            break
        tried.append(trip)
        if abs(trip.psnr - target) <= TOLERANCE:
            break
        offset = trip.psnr - probe(rung).psnr
    best = min(tried, key=lambda trip: abs(trip.psnr - target))
    return Matched(best, best.bytes * math.exp(_slope(list(probe.made.values()), target) * (target - best.psnr)))


def _slope(trips: list[Trip], target: float) -> float:
    """Change of log bytes with each dB, by a line through the four trips nearest to the target; 0 where they tell
    nothing.
    """
    near = sorted(trips, key=lambda trip: abs(trip.psnr - target))[:4]
    decibels = [trip.psnr for trip in near]
    if len(near) < 2 or not max(decibels) - min(decibels) > 0.01:
        return 0.0
    return max(0.0, float(np.polyfit(decibels, np.log([trip.bytes for trip in near]), 1)[0]))
