"""The base layer of a picture, in the integers that the stream will hold."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32
from sgicodec.model.base import base_colours, base_step, fit_base, render_base
from sgicodec.model.quantization import step_index
from sgicodec.model.spec import ModelSpec


def base_layer(spec: ModelSpec, unit: F32, lmbda: float) -> tuple[int, NDArray[np.int64], F32]:
    """Step index, integer grid [C, rows, columns], and what is left [C, H, W] of a tile's channels `unit` [C, H, W]."""
    channels, height, width = unit.shape
    if not spec.base_cell:
        return 0, np.zeros((channels, 0, 0), np.int64), unit
    # One colour stands for cell² pixels; half of its energy is its own: q² = 6 λ / (E ln 2).
    index = int(step_index(math.sqrt(12 * lmbda / math.log(2)) / spec.base_cell))
    grid = fit_base(unit, spec.base_cell)
    base = np.rint(grid / base_step(index)).astype(np.int64)
    drawn = render_base(base_colours(base, index), spec.base_cell, np.arange(width) + 0.5, np.arange(height) + 0.5)
    return index, base, unit - drawn
