"""The grids on which a residual layer codes the samples of a channel, and tables of samples (docs/format.md, "Residual
layer").
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.varint import encode_varint

_SCALES = (1, 10, 100, 1000, 10_000, 2, 4, 16, 64, 256, 1024, 4096)
"""Floats are often whole multiples of one over one of these."""
_MAX_TABLE = _native.MAX_TABLE_STEPS + 1


@dataclass(frozen=True)
class Grid:
    """base, step: value j stands for base + j · step; most: the largest value; max_error: by how much one is off.

    table: the samples that occur, rising, if values stand for these; is_whole: whether samples are whole numbers.
    """

    base: float
    step: float
    most: int
    max_error: int = 0
    table: NDArray[np.float32] | None = None
    is_whole: bool = False

    def coarser(self) -> Grid:
        """One on which no sample is off by more, and samples that are equal stay equal."""
        factor = 2 * self.max_error + 1
        most, rest = divmod(self.most, factor)
        base, step = self.base + min(rest, self.max_error) * self.step, factor * self.step
        return self if factor == 1 else replace(self, base=base, step=step, most=most, max_error=0)

    def encode(self) -> bytes:
        """As a layer states it."""
        reals = struct.pack("<2d", self.base, self.step)
        numbers = encode_varint(int(self.base)) + encode_varint(int(self.step)) if self.is_whole else reals
        return numbers + encode_varint(self.most) + encode_varint(self.max_error) + self._encode_table()

    def _encode_table(self) -> bytes:
        if self.table is None:
            return encode_varint(0)
        coded = _native.code_table(not self.is_whole, self.base, self.step, self.most, self.table)
        return encode_varint(len(coded)) + coded


class Integers:
    """The whole numbers that occur in a channel."""

    def __init__(self, sample_type: str) -> None:
        self._occurs = np.zeros(np.iinfo(sample_type).max + 1, np.bool_)

    def see(self, samples: NDArray[Any]) -> None:
        """More samples of the channel."""
        self._occurs[samples] = True

    def distinct(self) -> NDArray[np.float64]:
        """All of them, rising."""
        return np.flatnonzero(self._occurs).astype(np.float64)

    def exact_grid(self) -> Grid:
        """One with all samples on it."""
        return self.grid(0, None)

    def grid(self, max_error: float, blank: float | None) -> Grid:
        """One from which no sample is off by more; what is coded by it tells `blank` from samples."""
        values = np.flatnonzero(self._occurs)
        if not values.size:
            return Grid(0, 1, 0, is_whole=True)
        step = int(np.gcd.reduce(values - values[0])) or 1
        most = int(values[-1] - values[0]) // step
        return Grid(int(values[0]), step, most, min(most, int(max_error // step)), is_whole=True)


class Floats:
    """The floats that occur in a channel, while they are few, and the scales that make whole numbers of all of them."""

    def __init__(self) -> None:
        self.low = self.high = 0.0
        self._ranks: NDArray[np.int32] | None = np.zeros(0, np.int32)
        self._scales = list(_SCALES)

    def see(self, samples: NDArray[Any]) -> None:
        """More samples of the channel."""
        if samples.size:
            is_first = self._ranks is not None and not self._ranks.size
            low, high = float(samples.min()), float(samples.max())
            self.low, self.high = (low, high) if is_first else (min(self.low, low), max(self.high, high))
        for some in (samples[:1000], samples):
            self._scales = [scale for scale in self._scales if _are_whole(some, scale)]
        if self._ranks is not None:
            ranks = np.union1d(self._ranks, _turned(samples.view(np.int32)))
            self._ranks = ranks if ranks.size <= _MAX_TABLE else None

    def distinct(self) -> NDArray[np.float64] | None:
        """All of them, rising, 0 behind −0; None where they are many."""
        return None if self._ranks is None else _turned(self._ranks).view(np.float32).astype(np.float64)

    def exact_grid(self) -> Grid:
        """One with all samples on it, or near them."""
        reach = self.high - self.low
        scale = self._scale()
        if scale is not None:
            return Grid(self.low, 1 / scale, round(reach * scale))
        return Grid(self.low, reach / _native.MAX_GRID_STEPS or 1.0, _native.MAX_GRID_STEPS if reach else 0)

    def grid(self, max_error: float, blank: float | None) -> Grid | None:
        """One from which no sample is off by more, and on which `blank` is not; None if there is no such."""
        if self._ranks is not None and not self._ranks.size:
            return self.exact_grid()
        rounded = float(np.spacing(np.float32(max(abs(self.low), abs(self.high)))))
        free, scale = 2 * (max_error - rounded), self._scale()
        if scale is not None and max_error >= rounded:
            exact = self.exact_grid()
            is_exact = scale & (scale - 1) == 0
            most_off = min(exact.most, int((max_error - (0 if is_exact else rounded)) * scale))
            if (2 * most_off + 1) / scale >= free:
                return replace(exact, max_error=most_off)
        while free > 0 and (self.high - self.low) / free < _native.MAX_GRID_STEPS:
            grid = Grid(self.low, free, int((self.high - self.low) / free + 0.5))
            if blank is None or not _is_on(grid, blank):
                return grid
            free *= 0.999
        return None

    def _scale(self) -> int | None:
        """The least scale that makes whole numbers of all samples, not too large ones."""
        reach = self.high - self.low
        return next((scale for scale in self._scales if reach * scale <= _native.MAX_GRID_STEPS), None)


def _turned(bits: NDArray[np.int32]) -> NDArray[np.int32]:
    """The bits of floats as numbers that rise with them; the bits, if given those."""
    return np.where(bits < 0, np.int32(-1) - (bits & np.int32(0x7FFFFFFF)), bits)


def _are_whole(samples: NDArray[np.float32], scale: float) -> bool:
    wide = samples.astype(np.float64)
    return bool((np.rint(wide * scale) / scale).astype(np.float32).tobytes() == samples.tobytes())


def _is_on(grid: Grid, sample: float) -> bool:
    value = np.clip(round((sample - grid.base) / grid.step), 0, grid.most) if np.isfinite(sample) else 0
    return bool(np.float32(grid.base + grid.step * value) == np.float32(sample))


def with_table(channel: Integers | Floats, grid: Grid | None, max_error: float) -> Grid | None:
    """One on which values stand for samples that occur, none off by more; None where they are not fewer than steps."""
    samples, grid = channel.distinct(), grid or channel.exact_grid()
    if samples is None or len(samples) < 2:
        return None
    table = _thinned(samples, max_error)
    if len(table) * (2 * grid.max_error + 1) > grid.most:
        return None
    found = replace(grid, max_error=0, table=table.astype(np.float32))
    if not grid.is_whole:
        most = max(1, len(table) - 1)
        found = replace(
            found, base=float(table[0]), step=float(table[-1] - table[0]) / most or 1.0, most=len(table) - 1
        )
    return found


def _thinned(samples: NDArray[np.float64], max_error: float) -> NDArray[np.float64]:
    """As few of these, which rise, as leave none off by more."""
    if not max_error:
        return samples
    kept, at = [], 0
    while at < len(samples):
        kept.append(samples[np.searchsorted(samples, samples[at] + max_error, "right") - 1])
        at = int(np.searchsorted(samples, kept[-1] + max_error, "right"))
    return np.array(kept)
