"""What the tiles of a picture will come to at any λ, learnt from looks at all of them and from those that are done."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from sgicodec.rate_control.rd_model import bisected

__all__ = ["LMBDA_GRID", "Bound", "RdTable", "TileRdModel", "spread"]

LMBDA_GRID = tuple(2.0**octave for octave in range(-20, 3))
"""λ at which tiles are looked at."""


@dataclass(frozen=True)
class RdTable:
    """What a tile is foretold to come to at every λ of `LMBDA_GRID`: bytes, and squared error in its core."""

    bytes: tuple[float, ...]
    errors: tuple[float, ...]


class Coded(Protocol):
    """What is known of a finished tile: bytes of its payload, squared error in its core, and its λ."""

    @property
    def length(self) -> int: ...

    @property
    def squared_error(self) -> float: ...

    @property
    def lmbda(self) -> float: ...


@dataclass(frozen=True)
class Bound:
    """What all tiles together are to come to: bytes of their payloads, or squared error."""

    what: Literal["bytes", "error"]
    value: float

    def of(self, tile: Coded) -> float:
        """What a tile has of it."""
        return tile.length if self.what == "bytes" else tile.squared_error

    def need(self, total: float) -> float:
        """By how many octaves a total is off, positive where λ has to rise."""
        octaves = math.log2(max(total, 1e-9) / max(self.value, 1e-9))
        return octaves if self.what == "bytes" else -octaves


class TileRdModel:
    """Forecasts by the looks' tables, times the ratio of what was found to what was foretold of the tiles done."""

    def __init__(self, looks: Sequence[RdTable], what: Literal["bytes", "error"]) -> None:
        tables = np.array([look.bytes if what == "bytes" else look.errors for look in looks])  # [tiles, LMBDA_GRID]
        self._logs = np.log(np.maximum(tables, 1e-12))
        self._ratios: dict[float, float] = {}
        """Logarithms, by that of λ."""

    def foretold(self, numbers: Collection[int], lmbda: float) -> NDArray[np.float64]:
        """Of each of these tiles at λ."""
        known, ratio = sorted(self._ratios), 0.0
        if known:
            ratio = float(np.interp(math.log(lmbda), known, [self._ratios[at] for at in known]))
        return math.exp(ratio) * self._looked(numbers, lmbda)

    def _looked(self, numbers: Collection[int], lmbda: float) -> NDArray[np.float64]:
        at = np.clip(math.log2(lmbda), math.log2(LMBDA_GRID[0]), math.log2(LMBDA_GRID[-1])) - math.log2(LMBDA_GRID[0])
        first = min(int(at), len(LMBDA_GRID) - 2)
        logs, part = self._logs[list(numbers)], at - first
        values: NDArray[np.float64] = np.exp((1 - part) * logs[:, first] + part * logs[:, first + 1])
        return values

    def learn(self, bound: Bound, tiles: Mapping[int, Coded], lmbda: float) -> None:
        """Takes in what tiles came to at about λ. What others came to at another λ tells how the ratio changes with λ;
        its level is that of the most tiles at this one.
        """
        looked = sum(float(self._looked([number], tile.lmbda)[0]) for number, tile in tiles.items())
        found = sum(bound.of(tile) for tile in tiles.values())
        if found > 0 and looked > 1e-6:
            at, ratio = math.log(lmbda), math.log(found / looked)
            more = ratio - self._ratios.get(at, ratio)
            self._ratios = {key: known + more for key, known in self._ratios.items()} | {at: ratio}

    def lmbda(self, bound: Bound, numbers: Collection[int], done: float = 0.0) -> float:
        """λ at which these tiles, with what is done already, come to the bound."""
        return bisected(lambda lmbda: bound.need(done + float(self.foretold(numbers, lmbda).sum())) > 0, _HALVINGS)


def spread(weights: NDArray[np.float64], count: int) -> list[int]:
    """Up to `count` places, spread evenly over the weights that lie behind them."""
    behind = np.cumsum(weights + 1e-9 * (weights.sum() + 1.0))
    marks = (np.arange(count) + 0.5) / count * behind[-1]
    return sorted(set(np.searchsorted(behind, marks).tolist()))


_HALVINGS = 24
