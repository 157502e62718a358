"""Dither: samples of more than eight bits as eight, without contours in smooth skies."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.raster import Mapping

__all__ = ["dithered"]

F32 = NDArray[np.float32]


def dithered(
    values: F32, mapping: Mapping, at: tuple[int, int], alpha: int | None, dtype: np.dtype[Any]
) -> NDArray[Any]:
    """Samples of `dtype` for values [h, w, C] whose first pixel is output pixel `at` (x, y): each is rounded up or down
    so that the mean of a few pixels is the value. What a sample holds exactly stays; alpha is rounded to nearest.

    The threshold is interleaved gradient noise (Jimenez 2014), a function of the pixel and the channel alone, so that
    bands and threads do not show and equal streams make equal pictures.
    """
    rows, columns, channels = values.shape
    x = np.arange(at[0], at[0] + columns, dtype=np.float64)[None, :, None]
    y = np.arange(at[1], at[1] + rows, dtype=np.float64)[:, None, None]
    c = np.arange(channels, dtype=np.float64)
    threshold = np.modf(52.9829189 * np.modf(0.06711056 * (x + _APART * c) + 0.00583715 * (y + 2 * _APART * c))[0])[0]
    if alpha is not None:
        threshold[..., alpha] = 0.5
    threshold = _ROUNDING + (1 - 2 * _ROUNDING) * threshold
    samples: F32 = values * mapping.span + mapping.low + threshold.astype(np.float32)
    found: NDArray[Any] = np.floor(np.clip(samples, 0, np.iinfo(dtype).max)).astype(dtype)
    return found


_APART = 56
"""Pixels by which the noise of a channel is shifted, so that channels do not rise together."""
_ROUNDING = 1e-3
"""Levels by which a sample may be off for the rounding of floats."""
