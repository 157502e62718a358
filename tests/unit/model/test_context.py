"""What MLP_p sees: reach and weights of the hash grid."""

import numpy as np
import pytest

from sgicodec.model.context import HashGrid
from sgicodec.model.layout import uniform_layout
from sgicodec.profiles.paper import paper_spec

WIDTH, HEIGHT = 150, 90
PAPER = paper_spec(3).context


@pytest.mark.parametrize(("width", "height"), [(WIDTH, HEIGHT), (7, 400), (1, 1)])
def test_hash_grid_weights_and_reach(width: int, height: int) -> None:
    layout = uniform_layout(width, height, 300, np.random.default_rng(0))
    grid = HashGrid.at(PAPER, layout, width, height)
    levels = len(PAPER.hash_resolutions)
    assert grid.entry.shape == grid.weight.shape == (levels, len(layout), 4)
    assert np.all(grid.weight.sum(axis=2) == 4096)
    assert grid.weight.min() >= 0
    assert len(grid.sizes) == levels
    assert max(grid.sizes) <= 1 << PAPER.hash_log2_entries
    for entry, size in zip(grid.entry, grid.sizes, strict=True):
        assert entry.min() >= 0
        assert entry.max() < size
