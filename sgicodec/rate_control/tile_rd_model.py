"""R-D model of many tiles: predicts them at any λ from a lookahead, and learns from the tiles that are done."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from sgicodec.rate_control.allocation import Option
from sgicodec.rate_control.rd_model import bisected_lmbda
from sgicodec.rate_control.target import RateTarget

__all__ = ["LMBDA_GRID", "Bound", "CodedTile", "RdTable", "TileRdModel"]

LMBDA_GRID = tuple(2.0**octave for octave in range(-20, 3))
"""λ of the lookahead."""
LMBDA_HALVINGS = 24
AIM_FRACTION = {"bytes": 0.985, "error": 0.995}
"""Part of the bound at which fits aim."""
LIMIT_FRACTION = {"bytes": 1.0, "error": 10**0.003}
"""Part of the bound within which codings are chosen: a PSNR may be 0.03 dB below, so that both sides have room."""


@dataclass(frozen=True)
class RdTable:
    """Prediction for a tile at every λ of `LMBDA_GRID`: bytes, and squared error in its core."""

    bytes: tuple[float, ...]
    errors: tuple[float, ...]


class CodedTile(Protocol):
    """A finished tile: bytes of its payload, squared error and distortion in its core, and its λ."""

    @property
    def length(self) -> int: ...

    @property
    def squared_error(self) -> float: ...

    @property
    def distortion(self) -> float: ...

    @property
    def lmbda(self) -> float: ...


@dataclass(frozen=True)
class Bound:
    """What all tiles together may have: bytes of their payloads, or squared error."""

    what: Literal["bytes", "error"]
    value: float

    @classmethod
    def of_target(cls, target: RateTarget, side_bytes: float, samples: int, error_ratio: float) -> Bound:
        """side_bytes: of the stream beside the payloads. error_ratio: squared error of the picture, with its many
        samples, over that of the tiles' cores.
        """
        if target.psnr is not None:
            return cls("error", samples * 10 ** (-0.1 * target.psnr) / error_ratio)
        return cls("bytes", max(1.0, (target.bytes or 0.0) - side_bytes))

    @property
    def aim(self) -> Bound:
        """Where fits aim."""
        return replace(self, value=AIM_FRACTION[self.what] * self.value)

    @property
    def limit(self) -> float:
        """What the chosen codings may have together."""
        return LIMIT_FRACTION[self.what] * self.value

    def of(self, tile: CodedTile) -> float:
        """What a tile has of it."""
        return tile.length if self.what == "bytes" else tile.squared_error

    def option(self, tile: CodedTile) -> Option:
        """A coding of a tile for the allocation within this bound."""
        size = float(tile.length)
        return Option(size, tile.distortion) if self.what == "bytes" else Option(tile.squared_error, size)

    def error(self, total: float) -> float:
        """Octaves by which a total is off, positive where λ has to rise."""
        octaves = math.log2(max(total, 1e-9) / max(self.value, 1e-9))
        return octaves if self.what == "bytes" else -octaves


class TileRdModel:
    """Predicts by the tables of the lookahead, times the ratio of found to predicted of the tiles that are done."""

    def __init__(self, tables: Sequence[RdTable], what: Literal["bytes", "error"]) -> None:
        values = np.array([table.bytes if what == "bytes" else table.errors for table in tables])  # [tiles, LMBDA_GRID]
        self._logs = np.log(np.maximum(values, 1e-12))
        self._ratios: dict[float, float] = {}
        """Logarithms, by that of λ."""

    def predict(self, numbers: Collection[int], lmbda: float) -> NDArray[np.float64]:
        """Of each of these tiles at λ."""
        known, ratio = sorted(self._ratios), 0.0
        if known:
            ratio = float(np.interp(math.log(lmbda), known, [self._ratios[at] for at in known]))
        return math.exp(ratio) * self._tabled(numbers, lmbda)

    def _tabled(self, numbers: Collection[int], lmbda: float) -> NDArray[np.float64]:
        first_octave, last_octave = math.log2(LMBDA_GRID[0]), math.log2(LMBDA_GRID[-1])
        at = np.clip(math.log2(lmbda), first_octave, last_octave) - first_octave
        first = min(int(at), len(LMBDA_GRID) - 2)
        logs, part = self._logs[list(numbers)], at - first
        values: NDArray[np.float64] = np.exp((1 - part) * logs[:, first] + part * logs[:, first + 1])
        return values

    def learn(self, bound: Bound, tiles: Mapping[int, CodedTile], lmbda: float) -> None:
        """Learns from tiles that were coded at about λ. Tiles coded at another λ say how the ratio changes with λ; the
        largest set at this one says its level.
        """
        predicted = sum(float(self._tabled([number], tile.lmbda)[0]) for number, tile in tiles.items())
        measured = sum(bound.of(tile) for tile in tiles.values())
        if measured > 0 and predicted > 1e-6:
            at, ratio = math.log(lmbda), math.log(measured / predicted)
            more = ratio - self._ratios.get(at, ratio)
            self._ratios = {key: known + more for key, known in self._ratios.items()} | {at: ratio}

    def lmbda(self, bound: Bound, numbers: Collection[int], done: float = 0.0) -> float:
        """λ at which these tiles, with what is done already, reach the bound."""
        return bisected_lmbda(
            lambda lmbda: bound.error(done + float(self.predict(numbers, lmbda).sum())) > 0, LMBDA_HALVINGS
        )
