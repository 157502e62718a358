"""The Gaussian pyramid that a fit climbs down, coarse to fine (paper, section 3.3; Burt and Adelson 1983)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sgicodec._native import halved
from sgicodec.arrays import F32


class PyramidLevel(NamedTuple):
    """What a step is fitted to: samples [C, H, W], the picture's size times `scale`, and the weights of their squared
    errors [H, W], None where all are 1.
    """

    samples: F32
    scale: float = 1.0
    weights: F32 | None = None


_MIN_SIDE = 16
"""Pixels of the shorter side of a level that says something of a picture."""


def max_level(width: int, height: int) -> int:
    """The smallest level that a fit of a picture may begin at."""
    return max(0, (min(width, height) // _MIN_SIDE).bit_length() - 1)


def pyramid_levels(target: F32, weights: F32 | None, count: int) -> list[PyramidLevel]:
    """The pyramid of a picture and its weights."""
    maps = [None] * count if weights is None else [plane[0] for plane in pyramid(weights[None], count)]
    return [PyramidLevel(image, 0.5**level, maps[level]) for level, image in enumerate(pyramid(target, count))]


def pyramid(target: F32, levels: int) -> list[F32]:
    """[C, ⌈H / 2^l⌉, ⌈W / 2^l⌉] for l = 0 … levels − 1, filtered with (1, 3, 3, 1) / 8 along both axes.

    The even filter keeps pixel centres where halved coordinates put them, so a model at half scale needs no shift.
    """
    result = [np.ascontiguousarray(target, np.float32)]
    for _ in range(levels - 1):
        result.append(halved(result[-1]))
    return result
