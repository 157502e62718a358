"""Samples of more bits than a stream holds, as floats of 32 bits."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_SAME_NODATA = 1e-12
"""Relative difference up to which a float of 64 bits is what the text of a tag rounds."""


def narrowed(samples: NDArray[Any], nodata: float | None = None) -> tuple[NDArray[np.float32], float]:
    """Samples as floats of 32 bits, and by how much one is off at most; what is not finite or is nodata is not. nodata:
    as the samples hold it; others that would become its float become the next one.
    """
    with np.errstate(over="ignore"):
        narrow = samples.astype(np.float32, copy=False)
        blank = None if nodata is None else np.float32(nodata)
    if np.can_cast(samples.dtype, np.float32):
        return narrow, 0.0
    counts = np.isfinite(samples)
    if nodata is not None and blank is not None and not np.isnan(blank):
        counts &= ~_equal(samples, nodata)
        taken = counts & (narrow == blank)
        narrow[taken] = np.nextafter(blank, np.where(samples[taken] < blank, -np.inf, np.inf).astype(np.float32))
    off = np.abs(np.subtract(samples, narrow, dtype=np.float64)[counts])
    return narrow, float(off.max(initial=0.0))


def _equal(samples: NDArray[Any], nodata: float) -> NDArray[np.bool_]:
    if samples.dtype.kind in "iu":
        return np.asarray(samples == nodata)
    limits = np.finfo(samples.dtype)  # the text of the largest float, rounded up, is infinite
    return np.asarray(
        np.isclose(samples, np.clip(nodata, limits.min, limits.max), rtol=_SAME_NODATA, atol=0) | (samples == nodata)
    )
