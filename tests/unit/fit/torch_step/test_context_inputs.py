"""The hash grid's inputs: what bilinear interpolation must reproduce."""

import dataclasses

import numpy as np
import torch

from sgicodec.model.context import INPUT_BITS, HashGrid
from sgicodec.model.layout import uniform_layout
from sgicodec.profiles.paper import paper_spec
from tests.support.torch_step.context_inputs import hash_inputs

WIDTH, HEIGHT = 150, 90


def test_a_dense_level_interpolates_linearly() -> None:
    """Tables that hold x or y of their vertex come back as the seed's position in cells, to the fixed point's 1/64."""
    spec = dataclasses.replace(paper_spec(3).context, hash_resolutions=(18, 44))
    layout = uniform_layout(WIDTH, HEIGHT, 300, np.random.default_rng(0))
    grid = HashGrid.at(spec, layout, WIDTH, HEIGHT)
    tables = []
    for resolution, size in zip(spec.hash_resolutions, grid.sizes, strict=True):
        y, x = np.divmod(np.arange(size), resolution + 1)
        tables.append(torch.from_numpy(np.stack([x, y], axis=1)).double())
    found = hash_inputs(grid, tables, torch.from_numpy(grid.weight).double()).numpy()
    expected = np.concatenate([layout.centre * r / max(WIDTH, HEIGHT) for r in spec.hash_resolutions], axis=1)
    np.testing.assert_array_equal(np.floor(found), np.floor(expected * (1 << INPUT_BITS)))
