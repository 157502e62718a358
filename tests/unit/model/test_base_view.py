"""The base layer by footprints against the dense interpolation of float64."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec._native import base_view
from sgicodec.model.base import base_shape, render_base

CELL = 32
WIDTH, HEIGHT = 150, 70


@pytest.fixture
def grid() -> np.ndarray:
    """Colours of two channels for 150×70 pixels."""
    return np.random.default_rng(0).uniform(0, 1, (2, *base_shape(WIDTH, HEIGHT, CELL)))


def drawn(
    grid: np.ndarray,
    size: tuple[int, int],
    scale: tuple[float, float],
    start: tuple[int, int] = (0, 0),
    first: tuple[int, int] = (0, 0),
    threads: int = 1,
) -> np.ndarray:
    lines, top, down = base_view(grid, CELL, start, scale, first, size, threads)
    image = np.zeros((2, size[1], size[0]))
    for tap in range(down.shape[1]):
        image += lines[:, top + tap] * down[:, tap, None]
    return image


def dense(grid: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return render_base(grid, CELL, x, y)


@pytest.mark.parametrize("scale", [1.0, 2.5, 0.5])
def test_samples_at_the_centres_of_small_pixels(grid: np.ndarray, scale: float) -> None:
    size = (int(WIDTH * scale), int(HEIGHT * scale))
    x, y = ((np.arange(n) + 0.5) / scale for n in size)
    np.testing.assert_allclose(drawn(grid, size, (scale, scale)), dense(grid, x, y), atol=1e-6)


@pytest.mark.parametrize("factor", [10, 50])
def test_large_pixels_take_the_mean_of_their_area(grid: np.ndarray, factor: int) -> None:
    whole = dense(grid, np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    columns, rows = WIDTH // factor, HEIGHT // factor
    cut = whole[:, : rows * factor, : columns * factor]
    mean = cut.reshape(2, rows, factor, columns, factor).mean((2, 4))
    image = drawn(grid, (columns, rows), (1 / factor, 1 / factor))
    np.testing.assert_allclose(image, mean, atol=0.03)
    centres = dense(grid, (np.arange(columns) + 0.5) * factor, (np.arange(rows) + 0.5) * factor)
    assert np.abs(image - mean).mean() <= np.abs(centres - mean).mean()


@pytest.mark.parametrize("scale", [1.0, 0.02, 3.3])
def test_blocks_are_parts_of_the_whole(grid: np.ndarray, scale: float) -> None:
    size = (max(2, int(WIDTH * scale)), max(2, int(HEIGHT * scale)))
    whole = drawn(grid, size, (scale, scale), (3, 1))
    for left, top in ((0, 0), (1, 1), (size[0] // 2, size[1] // 3)):
        block = drawn(grid, (size[0] - left, size[1] - top), (scale, scale), (3, 1), (left, top), threads=2)
        np.testing.assert_array_equal(block, whole[:, top:, left:])
