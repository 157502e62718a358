"""Steps, rounding and the fixed point in which both sides compute what the entropy coder will read.

Every value that a later probability depends on is an integer in units of 2^-24 (`FRACTION_BITS`), every step one of
`STEP_COUNT` integers a sixth of an octave apart, every scale an index a sixth of an octave apart: no float decides.
Steps go from 2^-16 to 2: a coarser one says no more, and noise of its size would throw a Gaussian off the picture.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import (
    FRACTION_BITS,
    PER_OCTAVE,
    STEP_COUNT,
    STEP_ZERO,
)
from sgicodec.arrays import F64, I64

__all__ = [
    "FRACTION_BITS",
    "PER_OCTAVE",
    "STEP_COUNT",
    "STEP_ZERO",
    "step_fixed",
    "step_index",
]


# 2^(k/6) in units of 2^-40, rounded to nearest; octaves are shifts of these.
_SIXTHS = np.array([1099511627776, 1234160073853, 1385297844439, 1554944255988, 1745365914583, 1959106999532], np.int64)


def step_fixed(index: NDArray[np.integer]) -> I64:
    """The steps of the given indices (0 to STEP_COUNT − 1) in units of 2^-24; every one is at least 256."""
    index = np.asarray(index, np.int64)
    octave = index // PER_OCTAVE - STEP_ZERO // PER_OCTAVE
    shift = 40 - FRACTION_BITS - octave
    value = _SIXTHS[index % PER_OCTAVE]
    fixed: I64 = (value + (np.int64(1) << (shift - 1))) >> shift
    return fixed


def step_index(step: F64 | float) -> I64:
    """The index whose step is nearest to `step` on the logarithmic scale, clipped to the table."""
    index = np.rint(np.log2(np.asarray(step, np.float64)) * PER_OCTAVE) + STEP_ZERO
    clipped: I64 = np.clip(index, 0, STEP_COUNT - 1).astype(np.int64)
    return clipped
