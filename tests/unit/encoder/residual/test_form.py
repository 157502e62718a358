"""Grids of residual layers: no sample is off by more than was asked for."""

from __future__ import annotations

import numpy as np
import pytest
import reference_residual
from numpy.typing import NDArray

from sgicodec import EncodeSettings, Picture
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.residual.form import residual_form


def samples_of(pixels: NDArray[np.uint8], max_error: int) -> tuple[NDArray[np.int_], int]:
    """What values of the grid of a grey picture stand for, and by how much one may be off."""
    header = stream_plan(Shape.of(Picture(pixels, "gray", (0.0, 255.0))), EncodeSettings()).header
    grid, _ = reference_residual.grid_of(residual_form(header, [pixels], max_error), 9, True)
    return np.array([grid.sample(value) for value in range(grid.most + 1)], int), grid.most_off


@pytest.mark.parametrize("max_error", range(12))
@pytest.mark.parametrize("last", [1, 7, 20, 100, 251, 255])
def test_a_coarse_grid_is_near_all_samples(max_error: int, last: int) -> None:
    values = np.minimum(np.arange(256), last).astype(np.uint8)
    pixels = np.repeat(np.repeat(values, 4)[None, :, None], 2, axis=0)  # most are as the one to their left
    grid, most_off = samples_of(pixels, max_error)
    assert most_off == 0
    assert 0 <= grid.min() <= grid.max() <= last
    assert np.abs(values[:, None] - grid).min(axis=1).max() <= max_error


@pytest.mark.parametrize("max_error", range(12))
def test_few_values_are_numbered(max_error: int) -> None:
    """As few as lie near all that occur, where they are fewer than steps would be."""
    given = np.rint(np.arange(40) ** 1.5).astype(np.uint8)
    pixels = np.random.default_rng(3).choice(given, (200, 200, 1))
    grid, most_off = samples_of(pixels, max_error)
    assert most_off or set(grid) <= set(given)
    assert most_off or np.abs(given[:, None].astype(int) - grid).min(axis=1).max() <= max_error
    assert len(grid) / (2 * most_off + 1) <= min(len(given), 256 / (2 * max_error + 1) + 1)
