"""The base layer with weights against dense least squares."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.model.base import base_shape, cubic_weights
from sgicodec.model.weighted_base import base_gram, fit_weighted_base


@pytest.mark.parametrize(("height", "width", "cell"), [(37, 50, 8), (9, 70, 16), (5, 5, 8)])
def test_it_is_the_grid_of_least_weighted_squares(height: int, width: int, cell: int) -> None:
    rng = np.random.default_rng(height)
    image = rng.normal(size=(2, height, width)).astype(np.float32)
    weights = (10 ** rng.uniform(-1, 1, (height, width))).astype(np.float32)
    rows, columns = base_shape(width, height, cell)
    kernels = np.einsum(
        "py,qx->pqyx",
        cubic_weights(np.arange(height) + 0.5, rows, cell),
        cubic_weights(np.arange(width) + 0.5, columns, cell),
    ).reshape(height * width, rows * columns)
    root = np.sqrt(weights.astype(np.float64)).ravel()
    found = fit_weighted_base(image, weights, cell)
    for plane, grid in zip(image, found, strict=True):
        expected = np.linalg.lstsq(root[:, None] * kernels, root * plane.ravel(), rcond=None)[0]
        np.testing.assert_allclose(grid.ravel(), expected, atol=1e-5)
    dense = (kernels.T * weights.ravel()) @ kernels
    gram = base_gram(weights, cell)
    for y, x, v, u in np.ndindex(rows, columns, rows, columns):
        inner = dense[y * columns + x, v * columns + u]
        if abs(v - y) <= 3 and abs(u - x) <= 3:
            assert gram[y, x, v - y + 3, u - x + 3] == pytest.approx(inner, abs=1e-6)
        else:
            assert inner == 0
