"""The base layer at any scale, pixel by pixel the same whichever part of the picture is rendered."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import base_lines
from sgicodec.device import ONE_THREAD, Device
from sgicodec.model.base import cubic_weights

__all__ = ["BaseView", "base_view"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_SAMPLES_PER_CELL = 4
"""How densely the area of a pixel is sampled that covers cells rather than parts of one."""


class BaseView(NamedTuple):
    """B in a block of output pixels: row i is the sum over t of down[i, t] · lines[:, top[i] + t].

    lines [C, L, w], top [h], down [h, T].
    """

    lines: F32
    top: NDArray[np.int32]
    down: F32


def base_view(
    grid: F64,
    cell: int,
    start: tuple[float, float],
    scale: tuple[float, float],
    first: tuple[int, int],
    size: tuple[int, int],
    device: Device = ONE_THREAD,
) -> BaseView:
    """B in the block of `size` (w, h) pixels from pixel `first` (x, y) on of a picture drawn at `scale` from `start`.

    grid [C, rows, columns] holds the colours of cells of `cell` pixels. Output pixel (j, i) is the mean of B over the
    1/sx × 1/sy picture pixels from start + (first + (j, i)) / scale on, by one sample at its centre where it is small.
    """
    left, across = _footprints(start[0], scale[0], first[0], size[0], cell)
    top, down = _footprints(start[1], scale[1], first[1], size[1], cell)
    lines = np.empty((len(grid), int(top[-1] - top[0]) + down.shape[1], size[0]), np.float32)
    base_lines(np.ascontiguousarray(grid), int(top[0]), left, across, device.threads, lines)
    return BaseView(lines, (top - top[0]).astype(np.int32), down.astype(np.float32))


def _footprints(start: float, scale: float, first: int, count: int, cell: int) -> tuple[I64, F64]:
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
