"""Layers of texture as they are drawn; tests/conformance/test_exact_pixels.py compares pixels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sgicodec.model.texture_symbols import TextureIndices, TextureSymbols


def _layer(log_size: np.ndarray) -> TextureSymbols:
    """Of 72×40 pixels, with random symbols in cells of these sizes [2, 3], one to a superblock."""
    sizes = np.kron(log_size, np.ones((4, 4), int)).astype(np.uint8)
    symbols = np.random.default_rng(4).integers(-9, 10, (1, 64, 96)).astype(np.int16)
    return TextureSymbols((72, 40), TextureIndices(400), sizes, np.zeros((2, 3), np.int8), symbols)


def test_other_cells_are_refused() -> None:
    layer = _layer(np.array([[0, 0, 6], [0, 0, 0]]))
    with pytest.raises(ValueError, match="log_size"):
        layer.draw()
    with pytest.raises(ValueError, match="roots"):
        replace(_layer(np.zeros((2, 3), int)), size=(128, 40)).draw()


def test_a_cell_that_reaches_over_the_end_changes_no_other() -> None:
    """Of one size, which share their tables: one of them ends behind the tile."""
    both, over, inside = (_layer(np.array([[0, *sizes], [0, 0, 0]])).draw() for sizes in ((5, 5), (0, 5), (5, 0)))
    assert np.abs(inside[:, :28, 44:60]).max() > 0
    np.testing.assert_allclose(both, over + inside, atol=1e-5)
