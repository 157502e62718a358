"""The base layer B(x): one colour per cell, interpolated bicubically, so that Gaussians need not carry the mean."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32, F64
from sgicodec.model.quantization import FRACTION_BITS, step_fixed


def base_shape(width: int, height: int, cell: int) -> tuple[int, int]:
    """Rows and columns of the grid that covers a picture with cells of `cell` pixels."""
    return -(-height // cell), -(-width // cell)


def base_step(index: int) -> float:
    """The step of the base layer's integers."""
    return float(step_fixed(np.array(index))) * 2.0**-FRACTION_BITS


def base_colours(base: NDArray[np.int64], index: int) -> F64:
    """The cells' colours [C, rows, columns], from their integers `base` in steps of this index."""
    return np.asarray(base * base_step(index), np.float64)


def cubic_weights(positions: NDArray[np.floating], count: int, cell: float) -> F64:
    """Catmull–Rom weights [n, count] of the `count` cell centres at positions [n] in pixels, edges repeated."""
    at = positions / cell - 0.5
    first = np.floor(at).astype(np.int64)
    weights: F64 = np.zeros((len(positions), count))
    rows = np.arange(len(positions))
    for tap in range(-1, 3):
        d = np.abs(at - (first + tap))
        near = (1.5 * d - 2.5) * d * d + 1.0
        far = ((-0.5 * d + 2.5) * d - 4.0) * d + 2.0
        np.add.at(
            weights,
            (rows, np.clip(first + tap, 0, count - 1)),
            np.where(d <= 1, near, np.where(d < 2, far, 0)),
        )
    return weights


def render_base(grid: F64, cell: int, x: NDArray[np.floating], y: NDArray[np.floating]) -> F32:
    """B at pixel centres x [w], y [h] (picture pixels) from grid [C, rows, columns] → [C, h, w]."""
    across = cubic_weights(x, grid.shape[2], cell)
    down = cubic_weights(y, grid.shape[1], cell)
    return np.ascontiguousarray(down @ (grid @ across.T), dtype=np.float32)


def fit_base(image: F32, cell: int) -> F64:
    """The least-squares grid [C, rows, columns] of image [C, H, W]: separable, so two small solves."""
    _, height, width = image.shape
    rows, columns = base_shape(width, height, cell)
    across = np.linalg.pinv(cubic_weights(np.arange(width) + 0.5, columns, cell))
    down = np.linalg.pinv(cubic_weights(np.arange(height) + 0.5, rows, cell))
    return np.asarray(down @ (image @ across.T), np.float64)
