"""Cells of texture that none may have; tests/conformance/test_exact_pixels.py compares pixels."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.model.texture import TextureLayer


@pytest.mark.parametrize(
    ("corner", "log_size", "values"),
    [((0, 0), 2, 16), ((0, 0), 6, 4096), ((4, 0), 3, 64), ((0, -8), 3, 64), ((64, 0), 3, 64), ((0, 0), 3, 63)],
)
def test_other_cells_are_refused(corner: tuple[int, int], log_size: int, values: int) -> None:
    cells = np.array([corner], np.int32), np.array([log_size], np.uint8), np.zeros(values, np.float32)
    layer = TextureLayer((64, 64), 1, *cells, np.full((1, 1, 2), 4, np.uint8))
    with pytest.raises(ValueError, match=r"corner|log_size|amplitudes"):
        layer.draw()


def test_a_cell_that_reaches_over_the_end_changes_no_other() -> None:
    """Of one size, which share their tables: the first of them ends behind the tile."""
    rng = np.random.default_rng(4)
    corner, log_size = np.array([[64, 0], [32, 0]], np.int32), np.array([5, 5], np.uint8)
    amplitudes = rng.normal(size=(2, 32 * 32)).astype(np.float32)
    waves = np.full((2, 1, 2), 32, np.uint8)
    both, over, inside = (
        TextureLayer((72, 40), 1, corner[some], log_size[some], amplitudes[some].ravel(), waves[some]).draw()
        for some in (slice(0, 2), slice(0, 1), slice(1, 2))
    )
    assert np.abs(inside[:, :28, 44:60]).min() > 0
    np.testing.assert_allclose(both, over + inside, atol=1e-5)
