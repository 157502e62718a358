"""Regular patterns of a plane: stripes, ribs, slats, rows of stitches.

A pattern that repeats itself puts its power at one frequency. An edge has more of it the lower the frequency is, along
one direction; noise has as much of it in all directions. So the power near a frequency is compared with what there is
at lower frequencies of the same direction, and at the same frequency in other directions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.arrays import F32, F64
from sgicodec.device import ONE_THREAD, Device

BLOCK = _native.PATTERN_BLOCK
"""Side of the blocks that are told apart, pixels."""
_WINDOW = _native.PATTERN_WINDOW
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


def regular_patterns(plane: F64, device: Device = ONE_THREAD) -> RegularPatterns:
    """The patterns of a plane [H, W] in levels of 255, for each block of 8×8 pixels that it begins. Edges are
    mirrored.
    """
    spectrum = _spectrum()
    rows, columns = (-(-length // BLOCK) for length in plane.shape)
    before, whole = (_WINDOW - BLOCK) // 2, -(-columns // _native.MAX_LANES) * _native.MAX_LANES
    margins = [
        (before, _WINDOW + count * BLOCK - length) for count, length in zip((rows, whole), plane.shape, strict=True)
    ]
    beyond = np.pad(plane.astype(np.float32), margins, mode="symmetric")
    ratio, power = np.empty((rows, columns), np.float32), np.empty((rows, columns), np.float32)
    number = np.empty((rows, columns), np.int32)
    tables = spectrum.waves, *spectrum.own, *spectrum.others
    _native.regular_patterns(beyond, *tables, _NOISE, _DOUBTFUL, ratio, power, number, device.threads, device.isa)
    certainty = np.clip((ratio.astype(np.float64) - _DOUBTFUL) / (_CERTAIN - _DOUBTFUL), 0, 1)
    return RegularPatterns(certainty, np.sqrt(power.astype(np.float64)), spectrum.frequency[number])


Lines = tuple[NDArray[np.int32], NDArray[np.int32]]


@dataclass(frozen=True)
class _Spectrum:
    """How windows become power at frequencies (v, u), and what is compared for each pattern [P].

    waves [24, 12]: weighted cosines, then sines, of 0 to 11 cycles over half a window, from its middle; own, others:
    frequencies of which power is summed, pattern after pattern, and where each one's end; of all there are first those
    with v ≥ 0 and then those with v ≤ 0, each with u ≥ 0; frequency [P]: the pattern's.
    """

    waves: F32
    own: Lines
    others: Lines
    frequency: F64


@cache
def _spectrum() -> _Spectrum:
    half = np.arange(_WINDOW // 2)
    window = np.cos(np.pi * (half + 0.5) / _WINDOW) ** 2
    turns = 2 * np.pi / _WINDOW * np.outer(half, half + 0.5)
    waves = np.concatenate([np.cos(turns), np.sin(turns)]) * (window / np.sqrt(2 * (window**2).sum()))
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
    return _Spectrum(waves.astype(np.float32), _lines(near), _lines(others), frequency)


def _lines(chosen: NDArray[np.bool_]) -> Lines:
    """Which frequencies are chosen [P, F], as in `_Spectrum`."""
    return np.nonzero(chosen)[1].astype(np.int32), np.cumsum(chosen.sum(axis=1)).astype(np.int32)
