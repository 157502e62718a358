"""Samples of more bits than a stream holds, as floats of 32 bits."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def narrowed(samples: NDArray[Any], nodata: float | None = None) -> tuple[NDArray[np.float32], float]:
    """Samples as floats of 32 bits, and by how much one is off at most; what is not finite or becomes nodata is not."""
    with np.errstate(over="ignore"):
        narrow = samples.astype(np.float32, copy=False)
        blank = None if nodata is None else np.float32(nodata)
    if np.can_cast(samples.dtype, np.float32):
        return narrow, 0.0
    counts = np.isfinite(samples) & (True if blank is None else narrow != blank)
    off = np.abs(np.subtract(samples, narrow, dtype=np.float64)[counts])
    return narrow, float(off.max(initial=0.0))
