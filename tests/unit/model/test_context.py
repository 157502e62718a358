"""What MLP_p sees: reach, weights and causality."""

import dataclasses

import numpy as np
import pytest

from sgicodec.model.context import (
    INPUT_BITS,
    HashGrid,
    hash_inputs,
)
from sgicodec.model.layout import adaptive_layout, uniform_layout
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

WIDTH, HEIGHT = 150, 90
DETAIL = np.random.default_rng(0).normal(size=(3, HEIGHT, WIDTH)).astype(np.float32)
DETAIL *= np.linspace(0, 1, WIDTH, dtype=np.float32) ** 2
LAYOUT = adaptive_layout(DETAIL, 5.0)
DEFAULT, PAPER = default_spec(3).context, paper_spec(3).context


def shift(value: np.ndarray, bits: int) -> np.ndarray:
    return value >> bits


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


def test_a_dense_level_interpolates_linearly() -> None:
    """Tables that hold x or y of their vertex come back as the seed's position in cells, to the fixed point's 1/64."""
    spec = dataclasses.replace(PAPER, hash_resolutions=(18, 44))
    grid = HashGrid.at(spec, LAYOUT, WIDTH, HEIGHT)
    for level, resolution in enumerate(spec.hash_resolutions):
        across = resolution + 1
        vertex = np.arange(grid.sizes[level])
        table = np.stack([vertex % across, vertex // across], axis=1)
        one_level = HashGrid(
            grid.entry[level : level + 1], grid.weight[level : level + 1], grid.sizes[level : level + 1]
        )
        found = hash_inputs(one_level, slice(None), [table], one_level.weight, np.concatenate, shift)
        expected = LAYOUT.centre * resolution / max(WIDTH, HEIGHT)
        assert np.all(found == np.floor(expected * (1 << INPUT_BITS)))
