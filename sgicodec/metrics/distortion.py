"""How far decoded pictures are from their originals, in squared error that can be summed over parts."""

from __future__ import annotations

import math

import numpy as np

from sgicodec.picture import Picture, to_unit

__all__ = ["decibels", "squared_error"]


def squared_error(original: Picture, decoded: Picture) -> float:
    """Summed over samples in 0..1; colours that nobody sees count nothing."""
    error = 0.0
    for row in range(0, original.height, _ROWS):
        rows = slice(row, row + _ROWS)
        parts = (
            Picture(p.pixels[rows], p.channels, original.sample_range, original.metadata) for p in (original, decoded)
        )
        ours, theirs = (to_unit(part) for part in parts)
        difference = ours.astype(np.float64) - theirs
        if original.alpha is not None:
            difference[ours[..., original.alpha] == 0, : original.alpha] = 0
        error += float((difference**2).sum())
    return error


def decibels(error: float, samples: int) -> float:
    """PSNR of so many samples with this squared error; infinite for none."""
    return 10 * math.log10(samples / error) if error > 0 else math.inf


_ROWS = 64
