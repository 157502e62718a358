"""The base layer against dense least squares and what cubic interpolation must reproduce."""

import numpy as np
import pytest

from sgicodec.model.base import base_shape, cubic_weights, fit_base, render_base

CELL = 4


def centres(count: int) -> np.ndarray:
    return np.arange(count) + 0.5


@pytest.mark.parametrize(("width", "height"), [(17, 12), (16, 16), (3, 1), (1, 30)])
def test_the_fit_is_the_least_squares_optimum(width: int, height: int) -> None:
    image = np.random.default_rng(width).normal(size=(2, height, width)).astype(np.float32)
    rows, columns = base_shape(width, height, CELL)
    grid = fit_base(image, CELL)
    assert grid.shape == (2, rows, columns) == (2, -(-height // CELL), -(-width // CELL))
    dense = np.kron(
        cubic_weights(centres(height), rows, CELL), cubic_weights(centres(width), columns, CELL)
    )  # [H·W, rows·columns]
    expected, *_ = np.linalg.lstsq(dense, image.reshape(2, -1).T.astype(np.float64), rcond=None)
    np.testing.assert_allclose(grid.reshape(2, -1), expected.T, atol=1e-9)
    drawn = render_base(grid, CELL, centres(width), centres(height))
    np.testing.assert_allclose(drawn.reshape(2, -1), (dense @ expected).T, atol=1e-5)
