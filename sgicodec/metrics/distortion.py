"""Squared error between whole pictures, and the PSNR that it is. Unseen colours (alpha 0) count nothing."""

from __future__ import annotations

import math

import numpy as np

from sgicodec.picture import Picture, comparable, full_range


def squared_error(original: Picture, decoded: Picture) -> float:
    """Squared error summed over samples in 0..1; unseen colours count nothing."""
    error = 0.0
    for row in range(0, original.height, _ROWS):
        rows = slice(row, row + _ROWS)
        parts = (Picture(p.pixels[rows], p.channels, original.sample_range) for p in (original, decoded))
        ours, theirs = (comparable(part) for part in parts)
        difference = np.subtract(ours, theirs, dtype=np.float64)
        if original.alpha is not None:
            difference[ours[..., original.alpha] == 0, : original.alpha] = 0
        error += float(np.vdot(difference, difference)) / full_range(ours.dtype)[1] ** 2
    return error


def decibels(error: float, samples: int) -> float:
    """PSNR of this many samples with this squared error; infinite for none."""
    return 10 * math.log10(samples / error) if error > 0 else math.inf


_ROWS = 64
