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

F32 = NDArray[np.float32]
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
    spectrum = _spectrum()
    rows, columns = (-(-length // BLOCK) for length in plane.shape)
    certainty, deviation = np.zeros((rows, columns)), np.zeros((rows, columns))
    frequency = np.full((rows, columns), spectrum.frequency[0])
    for row, waves in enumerate(spectrum.waves(plane)):
        power = spectrum.power(waves)
        own = spectrum.own @ power
        told = np.flatnonzero(own.max(axis=0) > _DOUBTFUL * _NOISE)
        own, others = own[:, told], spectrum.others @ power[:, told]
        ratio = own / (others + np.float32(_NOISE))
        best = ratio.argmax(axis=0)[None]
        ratio, own = (np.take_along_axis(values, best, axis=0)[0] for values in (ratio, own))
        certainty[row, told] = np.clip((ratio - _DOUBTFUL) / (_CERTAIN - _DOUBTFUL), 0, 1)
        deviation[row, told] = np.sqrt(own)
        frequency[row, told] = spectrum.frequency[best[0]]
    return RegularPatterns(certainty, deviation, frequency)


@dataclass(frozen=True)
class _Spectrum:
    """How windows become power at frequencies (v, u), and what is compared for each pattern [P].

    basis [24, cosine or sine, 12]: weighted waves of 0 to 11 cycles; own, others [P, F]: sums over frequencies, of
    which F has v ≥ 0 and then v ≤ 0, each with u ≥ 0; frequency [P]: the pattern's.
    """

    basis: F32
    own: F32
    others: F32
    frequency: F64

    def waves(self, plane: F64) -> Iterator[F32]:
        """Of each row of blocks, waves along the rows of the windows [24, cosine or sine, 12, columns] around its
        blocks; edges are mirrored.
        """
        before = (_WINDOW - BLOCK) // 2
        rows, columns = (-(-length // BLOCK) for length in plane.shape)
        margins = [
            (before, _WINDOW + count * BLOCK - length)
            for count, length in zip((rows, columns), plane.shape, strict=True)
        ]
        beyond = np.pad(plane.astype(np.float32), margins, mode="symmetric")
        windows = np.lib.stride_tricks.sliding_window_view(beyond, _WINDOW, axis=1)[:, ::BLOCK][:, :columns]
        along = self.basis.reshape(_WINDOW, -1).T @ np.ascontiguousarray(windows.transpose(0, 2, 1))
        along = along.reshape(-1, *self.basis.shape[1:], columns)
        return (along[row * BLOCK :][:_WINDOW] for row in range(rows))

    def power(self, waves: F32) -> F32:
        """Power [F, columns] of windows about their means; that of a pattern sums to its variance."""
        both = np.tensordot(self.basis, waves, axes=(0, 0))  # [cosine or sine, v, cosine or sine, u, columns]
        of_one = self.basis.sum(axis=0)
        both -= np.multiply.outer(of_one, np.multiply.outer(of_one, both[0, 0, 0, 0] / of_one[0, 0] ** 2))
        (cc, cs), (sc, ss) = both.swapaxes(1, 2)  # [v, u, columns] each
        spectra = np.square(cc - ss) + np.square(cs + sc), np.square(cc + ss) + np.square(cs - sc)
        return np.float32(2 / _WINDOW**2) * np.concatenate(spectra).reshape(-1, waves.shape[-1])


@cache
def _spectrum() -> _Spectrum:
    window = np.sin(np.pi * (np.arange(_WINDOW) + 0.5) / _WINDOW) ** 2
    turns = 2 * np.pi / _WINDOW * np.outer(np.arange(_WINDOW), np.arange(_WINDOW // 2))
    basis = np.stack([np.cos(turns), np.sin(turns)], axis=1) * (window / np.sqrt((window**2).sum()))[:, None, None]
    sign, v, u = (part.ravel() for part in np.mgrid[1:-2:-2, : _WINDOW // 2, : _WINDOW // 2])
    once = np.where(sign > 0, (u > 0) | (v > 0), (u > 0) & (v > 0))  # of two opposite frequencies, one
    v *= sign
    radius, angle = np.hypot(v, u), np.arctan2(v, u)
    patterns = np.flatnonzero(once & (radius >= _MIN_FREQUENCY) & (radius <= _MAX_FREQUENCY))[:, None]
    distances = (np.hypot(v - by * v[patterns], u - by * u[patterns]) for by in (1, -1))
    near = once & (np.minimum(*distances) <= _LOBE)
    turned = np.abs((angle - angle[patterns] + np.pi / 2) % np.pi - np.pi / 2)
    lower = (radius <= radius[patterns] / _LOWER) & (turned < _ALONG)
    aside = (np.abs(radius - radius[patterns]) <= _AS_HIGH) & (turned > _ACROSS)
    others = once & ~near & (lower | aside)
    frequency = radius[patterns[:, 0]] / (_WINDOW / 2)
    return _Spectrum(basis.astype(np.float32), near.astype(np.float32), others.astype(np.float32), frequency)
