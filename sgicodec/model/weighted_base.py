"""The base layer that least squares finds where pixels have weights.

Weights are not separable, but a cell's kernel is four cells wide: the normal equations couple each cell with the 7×7
around it, and are summed exactly.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from sgicodec.model.base import base_shape, cubic_weights, fit_base

__all__ = ["base_gram", "fit_weighted_base"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_REACH = 3
"""Cells farther apart share no pixel (native/rdoq/base_search.hpp)."""


def base_gram(weights: F32, cell: int) -> F64:
    """Weighted inner products of every cell's kernel with those around it [rows, columns, 7, 7], zero beyond the grid.

    weights [H, W] of the pixels; element (y, x, i, j) is that of cells (y, x) and (y + i − 3, x + j − 3).
    """
    height, width = weights.shape
    rows, columns = base_shape(width, height, cell)
    down, across = (_neighbour_products(length, count, cell) for length, count in ((height, rows), (width, columns)))
    products = down.reshape(height, -1).T @ weights.astype(np.float64) @ across.reshape(width, -1)
    span = 2 * _REACH + 1
    return np.ascontiguousarray(products.reshape(span, rows, span, columns).transpose(1, 3, 0, 2))


def fit_weighted_base(image: F32, weights: F32, cell: int) -> F64:
    """The grid [C, rows, columns] of least weighted squared error for image [C, H, W] and weights [H, W].

    Conjugate gradients from the unweighted grid on, with the diagonal as preconditioner.
    """
    _, height, width = image.shape
    rows, columns = base_shape(width, height, cell)
    down = cubic_weights(np.arange(height) + 0.5, rows, cell)
    across = cubic_weights(np.arange(width) + 0.5, columns, cell)
    gram = base_gram(weights, cell)
    wanted = down.T @ (image * weights).astype(np.float64) @ across
    return np.stack([_solved(gram, b, x) for b, x in zip(wanted, fit_base(image, cell), strict=True)])


def _neighbour_products(length: int, count: int, cell: int) -> F64:
    """Products of each kernel with the 7 around it at every pixel of a line [length, 7, count]."""
    own = cubic_weights(np.arange(length) + 0.5, count, cell)
    padded = np.pad(own, [(0, 0), (_REACH, _REACH)])
    return np.stack([own * padded[:, i : i + count] for i in range(2 * _REACH + 1)], axis=1)


def _applied(gram: F64, grid: F64) -> F64:
    windows = sliding_window_view(np.pad(grid, _REACH), gram.shape[2:])
    applied: F64 = np.einsum("yxij,yxij->yx", gram, windows)
    return applied


def _solved(gram: F64, wanted: F64, grid: F64) -> F64:
    """The solution of gram · grid = wanted [rows, columns]; gram is positive definite."""
    scale = 1 / gram[:, :, _REACH, _REACH]
    residual = wanted - _applied(gram, grid)
    least = _PRECISION**2 * float(np.sum(wanted * scale * wanted))
    direction, power = np.zeros_like(grid), 1.0
    for _ in range(_MAX_ITERATIONS):
        scaled = scale * residual
        before, power = power, float(np.sum(residual * scaled))
        if power <= least:
            break
        direction = scaled + power / before * direction
        moved = _applied(gram, direction)
        step = power / float(np.sum(direction * moved))
        grid, residual = grid + step * direction, residual - step * moved
    return grid


_PRECISION, _MAX_ITERATIONS = 1e-7, 100
"""Relative residual at which the solution is good enough, far below a step of the base layer; and a bound."""
