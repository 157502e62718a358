"""Regular patterns of a plane: stripes, ribs, slats, rows of stitches.

A pattern that repeats itself puts its power at one frequency. An edge has more of it the lower the frequency is, along
one direction; noise has as much of it in all directions. So the power near a frequency is compared with what there is
at lower frequencies of the same direction, and at the same frequency in other directions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["BLOCK", "RegularPatterns", "regular_patterns"]

F64 = NDArray[np.float64]

BLOCK = 8
"""Side of the blocks that are told apart, pixels."""
_WINDOW = 24
"""Side of what is looked at around a block, pixels: about two ribs of a pattern at its lowest frequency. 16 and 32
were tried (docs/notes/2026-11-regular-patterns.md)."""
_MIN_FREQUENCY, _MAX_FREQUENCY = 3.9, 9.5
"""Frequencies of patterns, cycles in a window: periods of 2.5 to 6.2 pixels."""
_LOBE = 1.9
"""Reach of a pattern's power in the spectrum of a window, cycles in a window: few patterns are quite straight."""
_LOWER = 1.4
"""How many times higher a pattern's frequency is than the highest of those that it is compared with."""
_ALONG, _ACROSS = np.radians(27), np.radians(30)
"""Angles to a pattern's direction up to which, and from which on, power is compared with its own."""
_AS_HIGH = 1.5
"""Difference up to which frequencies count as the same, cycles in a window."""
_NOISE = 3.0
"""Power that counts against every pattern, levels²."""
_DOUBTFUL, _CERTAIN = 3.0, 6.0
"""Ratios of powers where a pattern begins to count, and where it counts in full
(docs/notes/2026-11-regular-patterns.md)."""


@dataclass(frozen=True)
class RegularPatterns:
    """The most regular pattern of each block [rows, columns]. certainty: 0 for none to 1; deviation: its standard
    deviation, in levels; frequency: 1 at a period of two pixels.
    """

    certainty: F64
    deviation: F64
    frequency: F64


def regular_patterns(plane: F64) -> RegularPatterns:
    """The patterns of a plane [H, W] in levels of 255, for each block of 8×8 pixels that it begins."""
    spectrum, found = _spectrum(), []
    for windows in _windows(plane):
        power = spectrum.power(windows)
        own, others = power @ spectrum.own, power @ spectrum.others
        ratio = own / (others + _NOISE)
        best = ratio.argmax(axis=1)[:, None]
        ratio, own = (np.take_along_axis(values, best, axis=1)[:, 0] for values in (ratio, own))
        certainty = np.clip((ratio - _DOUBTFUL) / (_CERTAIN - _DOUBTFUL), 0, 1)
        found.append((certainty, np.sqrt(own), spectrum.frequency[best[:, 0]]))
    return RegularPatterns(*(np.stack(rows) for rows in zip(*found, strict=True)))


def _windows(plane: F64) -> Iterator[F64]:
    """Windows [columns, 24, 24] around the blocks of each row of blocks; edges are mirrored."""
    before = (_WINDOW - BLOCK) // 2
    rows, columns = (-(-length // BLOCK) for length in plane.shape)
    margins = [
        (before, _WINDOW + count * BLOCK - length) for count, length in zip((rows, columns), plane.shape, strict=True)
    ]
    beyond = np.pad(plane, margins, mode="symmetric")
    for row in range(rows):
        strip = beyond[row * BLOCK :][:_WINDOW]
        yield np.lib.stride_tricks.sliding_window_view(strip, (_WINDOW, _WINDOW))[0, ::BLOCK][:columns]


@dataclass(frozen=True)
class _Spectrum:
    """How windows are weighed, which of their frequencies [F] count, and what is compared for each pattern [P]: own and
    others [F, P] are sums over frequencies; frequency [P] is the pattern's.
    """

    weights: F64
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    own: F64
    others: F64
    frequency: F64

    def power(self, windows: F64) -> F64:
        """Power [columns, F] of windows about their means; that of a pattern sums to its variance."""
        means = np.tensordot(windows, self.weights, axes=2) / self.weights.sum()
        spectra = np.fft.rfft2((windows - means[:, None, None]) * self.weights)[:, self.rows, self.columns]
        return np.asarray(2 / self.weights.size * np.abs(spectra) ** 2)


@cache
def _spectrum() -> _Spectrum:
    wave = np.sin(np.pi * (np.arange(_WINDOW) + 0.5) / _WINDOW) ** 2
    weights = np.outer(wave, wave)
    highest = min(int(np.ceil(_MAX_FREQUENCY + _LOBE)), _WINDOW // 2 - 1)
    v, u = (part.ravel() for part in np.mgrid[-highest : highest + 1, 0 : highest + 1])
    half = (u > 0) | (v > 0)  # of two opposite frequencies, one
    v, u = v[half], u[half]
    radius, angle = np.hypot(v, u), np.arctan2(v, u)
    patterns = np.flatnonzero((radius >= _MIN_FREQUENCY) & (radius <= _MAX_FREQUENCY))
    distances = (np.hypot(v[:, None] - sign * v[patterns], u[:, None] - sign * u[patterns]) for sign in (1, -1))
    near = np.minimum(*distances) <= _LOBE
    turned = np.abs((angle[:, None] - angle[patterns] + np.pi / 2) % np.pi - np.pi / 2)
    lower = (radius[:, None] <= radius[patterns] / _LOWER) & (turned < _ALONG)
    aside = (np.abs(radius[:, None] - radius[patterns]) <= _AS_HIGH) & (turned > _ACROSS)
    return _Spectrum(
        weights / np.sqrt((weights**2).sum()),
        v % _WINDOW,
        u,
        near.astype(np.float64),
        (~near & (lower | aside)).astype(np.float64),
        radius[patterns] / (_WINDOW / 2),
    )
