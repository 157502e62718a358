"""What a fit will come to at any λ, from the picture alone."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sgicodec.model.layout import ROOT_LOG, cell_sums, leaf_sums
from sgicodec.rate_control.target import LMBDA_RANGE, Measured, RateTarget

__all__ = ["EMPTY_STREAM_BYTES", "HIGHER_PRICE", "RdModel", "bisected", "initial_lmbda"]


def initial_lmbda(goal: RateTarget, detail: NDArray[np.float32], seed_price: float, extra: float = 0.0) -> float:
    """Where to begin: λ at which the seeds that a fit of `detail` [C, H, W] starts with foretell the goal. `extra`
    bytes come on top.

    The forecast knows what the search for symbols will gain.
    """
    rd_model = RdModel(detail, seed_price)

    def must_rise(lmbda: float) -> bool:
        size, error = rd_model.predict(lmbda)
        return goal.rate_error(Measured(size + extra, -10 * math.log10(error))) > 0

    return bisected(must_rise, 8)


def bisected(must_rise: Callable[[float], bool], halvings: int) -> float:
    """λ in LMBDA_RANGE below which `must_rise` holds, by halving octaves so many times."""
    low, high = (math.log2(limit) for limit in LMBDA_RANGE)
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if must_rise(2.0**middle) else (low, middle)
    return float(2.0 ** (0.5 * (low + high)))


HIGHER_PRICE = 4.0
"""Price of a seed at which forecasts of error count seeds once more."""
_FLAT = 1e-9
"""Squared deviation that stands for none."""
EMPTY_STREAM_BYTES = 200.0
"""Of a stream without seeds, about."""


class RdModel:
    """What a fit of `detail` [C, H, W], a picture less its base layer, will come to at any λ.

    Forecasts are products of powers of λ, of the number of seeds and of what deviates within their cells, fitted to
    photographs; that of the error also sees both at four times the price of a seed: how quickly more seeds become
    worth their bits tells fine texture from edges (docs/notes/2026-11-rd-model.md).
    """

    def __init__(self, detail: NDArray[np.float32], seed_price: float) -> None:
        self.seed_price, self.channels, self.pixels = seed_price, len(detail), detail[0].size
        self._sums = cell_sums(detail, ROOT_LOG)

    def predict(self, lmbda: float) -> tuple[float, float]:
        """Bytes of the stream and mean squared error of a sample in 0..1."""
        (count, deviation), (fewer, larger) = self.seeds(lmbda), self.seeds(lmbda, HIGHER_PRICE)
        size = EMPTY_STREAM_BYTES + self.pixels * 0.5 * lmbda**-0.33 * count**0.77 * deviation**0.36
        error = 2.8 * lmbda**0.918 * count**2.85 * fewer**-1.91 * deviation**2.43 * larger**-2.39
        return size, error / self.channels

    def seeds(self, lmbda: float, price: float = 1.0) -> tuple[float, float]:
        """For each pixel, their number and what deviates within their cells, where one costs `price` times as much."""
        count, deviation = leaf_sums(self._sums, price * self.seed_price * lmbda)
        return count / self.pixels, max(deviation / self.pixels, _FLAT)
