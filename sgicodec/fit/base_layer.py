"""The base layer of a picture, in the integers that the stream will hold."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sgicodec.model.base import base_colours, base_step, fit_base, render_base
from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.quantization import step_index
from sgicodec.model.spec import ModelSpec

__all__ = ["base_layer"]

F32 = NDArray[np.float32]


def base_layer(spec: ModelSpec, unit: F32, lmbda: float) -> tuple[int, NDArray[np.int64], F32]:
    """Step index, integer grid [C, rows, columns], and what is left [C, H, W] of a picture `unit` [C, H, W] in 0..1."""
    channels, height, width = unit.shape
    if not spec.base_cell:
        return 0, np.zeros((channels, 0, 0), np.int64), unit
    opponent = np.array(colour_matrix(channels))
    # One colour stands for cell² pixels; half of its energy is its own: q² = 6 λ / (E ln 2).
    index = int(step_index(math.sqrt(12 * lmbda / math.log(2)) / spec.base_cell))
    grid = fit_base(_mixed(opponent, unit), spec.base_cell)
    base = np.rint(grid / base_step(index)).astype(np.int64)
    drawn = render_base(base_colours(base, index), spec.base_cell, np.arange(width) + 0.5, np.arange(height) + 0.5)
    return index, base, unit - drawn


def _mixed(matrix: NDArray[np.float64], unit: F32) -> F32:
    """matrix [C, C] times a picture [C, H, W], in float64, some rows at a time: they stay in the cache."""
    mixed, rows = np.empty_like(unit), max(1, _AT_ONCE // unit.shape[2])
    for top in range(0, unit.shape[1], rows):
        part = unit[:, top : top + rows].astype(np.float64)
        mixed[:, top : top + rows] = (matrix @ part.reshape(len(part), -1)).reshape(part.shape)
    return mixed


_AT_ONCE = 1 << 14
"""Pixels that are mixed at once."""
