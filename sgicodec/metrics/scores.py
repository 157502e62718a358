"""What `sgi compare` and `sgi bench` report of two pictures: all figures at once, and a picture of the error."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sgicodec.errors import UsageError
from sgicodec.metrics.psnr import Pixels, bands, check_pair, difference, luma, peak_of, plane_psnr, psnr
from sgicodec.metrics.similarity import combine, scale_terms


@dataclass(frozen=True)
class Scores:
    """The figures of one comparison: PSNR in dB (infinite for equal pictures), similarities up to 1."""

    psnr: float
    luma_psnr: float
    ssim: float
    ms_ssim: float


def scores(a: Pixels, b: Pixels) -> Scores:
    """All four figures, sharing the work between them. Raises UsageError if shapes or types differ."""
    rgb = psnr(a, b)
    luma_a, luma_b = luma(a), luma(b)
    terms = scale_terms(luma_a, luma_b)
    return Scores(rgb, plane_psnr(luma_a, luma_b), terms[0][0], combine(terms))


def error_map(a: Pixels, b: Pixels, *, gain: float = 8.0) -> npt.NDArray[np.uint8]:
    """The signed error b − a as an 8-bit picture [H, W, C]: mid-gray where equal, `gain` per level.

    Levels are 1/255 of the peak. Raises UsageError if shapes or types differ or `gain` is not positive or not finite.
    """
    check_pair(a, b)
    scale = gain * 255.0 / peak_of(a)
    if not 0 < scale < math.inf:
        raise UsageError(f"the gain of an error map must be positive and finite, not {gain:g}")
    out = np.empty(a.shape, np.uint8)
    for rows in bands(a.shape[0]):
        out[rows] = np.clip(np.rint(128.0 - difference(a[rows], b[rows]) * scale), 0, 255)
    return out
