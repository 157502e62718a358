"""The base layer seen at any scale, pixel by pixel the same whichever part of the picture is drawn."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sgicodec.model.base import cubic_weights

__all__ = ["add_base"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_SAMPLES_PER_CELL = 4
"""How densely the area of a pixel is sampled that covers cells rather than parts of one."""


def add_base(
    image: F32, grid: F64, cell: int, start: tuple[int, int], scale: tuple[float, float], first: tuple[int, int]
) -> None:
    """Adds B to image [C, h, w], the block from pixel `first` (x, y) on of a picture drawn at `scale` from `start`.

    grid [C, rows, columns] holds the colours of cells of `cell` pixels. Output pixel (j, i) is the mean of B over the
    1/sx × 1/sy picture pixels from start + (first + (j, i)) / scale on, by one sample at its centre where it is small.
    """
    _, height, width = image.shape
    left, across = _footprints(start[0], scale[0], first[0], width, cell)
    top, down = _footprints(start[1], scale[1], first[1], height, cell)
    rows = np.clip(np.arange(top[0], top[-1] + down.shape[1]), 0, grid.shape[1] - 1)
    lines = np.zeros((len(grid), len(rows), width), np.float32)
    for tap in range(across.shape[1]):
        columns = np.clip(left + tap, 0, grid.shape[2] - 1)
        lines += grid[:, rows[:, None], columns] * across[:, tap]
    bounds = [0, *(np.flatnonzero(np.diff(top)) + 1).tolist(), height]
    for begin, end in pairwise(bounds):
        band = image[:, begin:end]
        for tap in range(down.shape[1]):
            band += lines[:, None, top[begin] - top[0] + tap] * down[begin:end, tap, None].astype(np.float32)


def _footprints(start: int, scale: float, first: int, count: int, cell: int) -> tuple[I64, F64]:
    """For `count` output pixels along an axis the first cell of each and the weights [count, T] of it and those after.

    Cells may lie outside the grid: those of its edges stand for them.
    """
    samples = max(1, math.ceil(_SAMPLES_PER_CELL / (scale * cell)))
    inside = (np.arange(samples) + 0.5) / samples
    at = (start + (first + np.arange(count)[:, None] + inside) / scale) / cell - 0.5  # [count, samples] in cells
    lowest = np.floor(at).astype(np.int64)
    taps = cubic_weights((at - lowest).reshape(-1) + 1.5, 4, 1.0).reshape(count, samples, 4)
    offset = lowest - lowest[:, :1]
    weights = np.zeros((count, int(offset.max(initial=0)) + 4))
    rows = np.arange(count)
    for sample in range(samples):
        for tap in range(4):
            weights[rows, offset[:, sample] + tap] += taps[:, sample, tap] / samples
    return lowest[:, 0] - 1, weights
