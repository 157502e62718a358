"""The base layer against dense least squares and what cubic interpolation must reproduce."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sgicodec.model.base import base_colours, base_shape, cubic_weights, fit_base, render_base

CELL = 4


def centres(count: int) -> np.ndarray:
    return np.arange(count) + 0.5


@given(arrays(np.float64, st.integers(1, 20), elements=st.floats(-100, 1000)), st.integers(1, 12), st.floats(1, 64))
def test_weights_are_a_partition_of_unity(positions: np.ndarray, count: int, cell: float) -> None:
    weights = cubic_weights(positions, count, cell)
    assert weights.shape == (len(positions), count)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-9)


def test_weights_are_catmull_rom() -> None:
    """Against the curve through four points whose slopes are central differences, as a cubic Hermite polynomial."""
    values = np.array([3.0, -1.0, 4.0, 1.5, -5.0, 9.0])
    for t in np.linspace(0, 1, 11):
        p0, p1, p2, p3 = values[1:5]
        hermite = (
            (2 * t**3 - 3 * t**2 + 1) * p1
            + (t**3 - 2 * t**2 + t) * (p2 - p0) / 2
            + (3 * t**2 - 2 * t**3) * p2
            + (t**3 - t**2) * (p3 - p1) / 2
        )
        drawn = cubic_weights(np.array([(2.5 + t) * CELL]), 6, CELL) @ values
        assert drawn[0] == pytest.approx(hermite)


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


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_colours_of_integers(channels: int) -> None:
    """Luma and two differences of the first three channels, others as they are; step 84 is 2^((84 − 96) / 6) = 1/4."""
    base = np.random.default_rng(channels).integers(-40, 40, (channels, 3, 2))
    colours = base_colours(base, 84)
    opponent = colours.copy()
    if channels >= 3:
        red, green, blue = colours[:3]
        opponent[0] = (red + green + blue) / np.sqrt(3)
        opponent[1] = (red - blue) / np.sqrt(2)
        opponent[2] = (2 * green - red - blue) / np.sqrt(6)
    np.testing.assert_allclose(opponent, base / 4, atol=1e-12)
