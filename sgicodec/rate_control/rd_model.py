"""R-D model of a picture: predicts the size and the error of a fit at any λ from the statistics of its cells."""

from __future__ import annotations

import math
from collections.abc import Callable

from sgicodec.model.layout import CellSums, leaf_sums
from sgicodec.rate_control.target import (
    LMBDA_MAX,
    LMBDA_MIN,
    Measured,
    RateTarget,
)

__all__ = [
    "EMPTY_STREAM_BYTES",
    "HIGHER_PRICE",
    "RdModel",
    "bisected_lmbda",
    "initial_lmbda",
    "network_bytes",
    "tile_side_bytes",
]


EMPTY_STREAM_BYTES = 200.0
"""Of a stream without seeds, base layer included."""
TILE_BYTES = 30.0
"""Of one tile of several without seeds: the header is the stream's."""
NETWORK_WEIGHT_BYTES = 1.2
"""For each weight of a network that travels in the stream."""


def network_bytes(weights: int) -> float:
    """Bytes of a context network of `weights` weights that the stream carries."""
    return NETWORK_WEIGHT_BYTES * weights


def tile_side_bytes(weights: int) -> float:
    """Bytes of a tile of several without seeds, with a network of `weights` weights."""
    return TILE_BYTES + network_bytes(weights)


HIGHER_PRICE = 4.0
"""Factor on the price of a seed at which the prediction of the error counts seeds once more
(docs/notes/2026-11-rd-model.md)."""
MIN_DEVIATION = 1e-9
"""Squared deviation of a pixel that stands for none."""
INITIAL_LMBDA_HALVINGS = 8


class RdModel:
    """Predicts bytes and error of a fit of a picture less its base layer.

    sums: statistics of the picture's cells (`cell_sums`). seed_price: squared deviation that splits a cell, for each
    unit of λ. weight: what the distortion is of squared error on this picture: a fit at λ ends where one for squared
    error ends at λ / weight. The predictions are products of powers of λ, of the number of seeds and of the
    deviation within their cells, fitted to photographs. That of the error also sees both at four times the price of a
    seed: how fast more seeds become worth their bits tells fine texture from edges (docs/notes/2026-11-rd-model.md).
    """

    def __init__(self, sums: CellSums, channels: int, pixels: int, seed_price: float, weight: float = 1.0) -> None:
        self.channels, self.pixels, self.seed_price, self.weight = channels, pixels, seed_price, weight
        self._sums = sums

    def predict(self, lmbda: float) -> tuple[float, float]:
        """Bytes of the stream and mean squared error of a sample in 0..1."""
        lmbda /= self.weight
        (count, deviation), (fewer, larger) = self.seeds(lmbda), self.seeds(lmbda, HIGHER_PRICE)
        size = EMPTY_STREAM_BYTES + self.pixels * 0.5 * lmbda**-0.33 * count**0.77 * deviation**0.36
        error = 2.8 * lmbda**0.918 * count**2.85 * fewer**-1.91 * deviation**2.43 * larger**-2.39
        return size, error / self.channels

    def seeds(self, lmbda: float, price: float = 1.0) -> tuple[float, float]:
        """Number of seeds and squared deviation within their cells, per pixel, with seeds at `price` times their
        price.
        """
        count, deviation = leaf_sums(self._sums, price * self.seed_price * lmbda)
        return count / self.pixels, max(deviation / self.pixels, MIN_DEVIATION)


def initial_lmbda(target: RateTarget, rd_model: RdModel, extra: float = 0.0) -> float:
    """λ at which the R-D model predicts the target, `extra` bytes beside its prediction included.

    It knows nothing of scores: for them it is where most photographs have them.
    """
    if target.usual_lmbda is not None:
        return target.usual_lmbda

    def must_rise(lmbda: float) -> bool:
        size, error = rd_model.predict(lmbda)
        return target.rate_error(Measured(size + extra, -10 * math.log10(error))) > 0

    return bisected_lmbda(must_rise, INITIAL_LMBDA_HALVINGS)


def bisected_lmbda(must_rise: Callable[[float], bool], halvings: int) -> float:
    """λ between LMBDA_MIN and LMBDA_MAX below which `must_rise` holds, by halving its octaves repeatedly."""
    low, high = math.log2(LMBDA_MIN), math.log2(LMBDA_MAX)
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if must_rise(2.0**middle) else (low, middle)
    return float(2.0 ** (0.5 * (low + high)))
