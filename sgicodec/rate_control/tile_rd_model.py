"""R-D model of many tiles: predicts them at any λ from a lookahead, and learns from the tiles that are done."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sgicodec.rate_control.rd_model import bisected_lmbda

__all__ = ["LMBDA_GRID", "RdTable", "TileRdModel", "is_far", "spread_over"]

LMBDA_GRID = tuple(2.0**octave for octave in range(-20, 3))
"""λ of the lookahead."""
LMBDA_HALVINGS = 24
MAX_SPREAD_OCTAVES = 0.5
"""How far the λ of the fits of one stream may lie apart."""


@dataclass(frozen=True)
class RdTable:
    """Prediction for a tile at every λ of `LMBDA_GRID`: bytes, and squared error in its core."""

    bytes: tuple[float, ...]
    errors: tuple[float, ...]


class TileRdModel:
    """Predicts bytes, or squared error, by the tables of the lookahead, times the ratio of found to predicted of the
    tiles that are done.
    """

    def __init__(self, tables: Sequence[RdTable], what: Literal["bytes", "error"]) -> None:
        self._what = what
        values = np.array([table.bytes if what == "bytes" else table.errors for table in tables])  # [tiles, LMBDA_GRID]
        self._logs = np.log(np.maximum(values, 1e-12))
        self._ratios: dict[float, float] = {}
        """Logarithms, by that of λ."""

    def predict(self, lmbda: float) -> NDArray[np.float64]:
        """Of each tile at λ."""
        known, ratio = sorted(self._ratios), 0.0
        if known:
            ratio = float(np.interp(math.log(lmbda), known, [self._ratios[at] for at in known]))
        return math.exp(ratio) * self._tabled(lmbda)

    def _tabled(self, lmbda: float) -> NDArray[np.float64]:
        first_octave, last_octave = math.log2(LMBDA_GRID[0]), math.log2(LMBDA_GRID[-1])
        at = np.clip(math.log2(lmbda), first_octave, last_octave) - first_octave
        first = min(int(at), len(LMBDA_GRID) - 2)
        part = at - first
        values: NDArray[np.float64] = np.exp((1 - part) * self._logs[:, first] + part * self._logs[:, first + 1])
        return values

    def learn(self, numbers: Collection[int], lmbda: float, found: float) -> None:
        """Learns what these tiles have together, coded at λ."""
        predicted = float(self._tabled(lmbda)[list(numbers)].sum())
        if found > 0 and predicted > 1e-6:
            self._ratios[math.log(lmbda)] = math.log(found / predicted)

    def lmbda(self, wanted: float) -> float:
        """λ at which all tiles together have what is wanted."""
        is_size = self._what == "bytes"
        return bisected_lmbda(lambda lmbda: (float(self.predict(lmbda).sum()) > wanted) == is_size, LMBDA_HALVINGS)


def is_far(one: float, other: float) -> bool:
    """Whether two λ lie too far apart for the fits of one stream."""
    return abs(math.log2(one / other)) > MAX_SPREAD_OCTAVES


def spread_over(weights: NDArray[np.float64], count: int) -> list[int]:
    """Up to `count` indices, spread evenly over the cumulative weights."""
    behind = np.cumsum(weights + 1e-9 * (weights.sum() + 1.0))
    marks = (np.arange(count) + 0.5) / count * behind[-1]
    return sorted(set(np.searchsorted(behind, marks).tolist()))
