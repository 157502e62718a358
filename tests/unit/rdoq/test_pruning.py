"""Which seeds go, against dense sums in float64."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.raster.reference import rasterize_reference
from sgicodec.rdoq import Scene
from sgicodec.rdoq.objective import joined
from sgicodec.rdoq.pruning import without_losers

Stage = Callable[..., tuple[Scene, TileModel]]


def test_each_goes_that_costs_less_than_it_is_worth(stage: Stage) -> None:
    """One after the other, the faintest for their worth first."""
    scene, model = stage(height=40, width=60)
    rng = np.random.default_rng(3)
    worth = rng.uniform(0, 0.3, len(model.layout))
    means, covariances, colours = (array.astype(np.float64) for array in scene.gaussians(model))
    values = rasterize_reference(means, covariances, np.eye(len(means)), 60, 40)  # [N, H, W]
    residual = scene.picture - np.einsum("nc,nyx->cyx", colours, values)
    energy = (colours**2).sum(1) * np.sqrt(covariances[:, 0] * covariances[:, 2] - covariances[:, 1] ** 2)
    keep = np.ones(len(means), bool)
    for i in np.argsort(energy / worth, kind="stable"):
        without = residual + colours[i][:, None, None] * values[i]
        change = np.sum(without**2) - np.sum(residual**2)
        assert abs(change - worth[i]) > 1e-4, "too close to tell: choose another seed for this test"
        if change < worth[i]:
            keep[i], residual = False, without
    assert 5 < keep.sum() < len(keep) - 5
    found = without_losers(scene, model, worth)
    np.testing.assert_array_equal(joined(found), joined(model)[keep])
    np.testing.assert_array_equal(found.layout.corner, model.layout.corner[keep])


@pytest.mark.parametrize("threads", [1, 3])
def test_same_seeds_for_any_number_of_threads(stage: Stage, threads: int) -> None:
    scene, model = stage(height=150, width=170)
    worth = np.full(len(model.layout), 0.05)
    expected = joined(without_losers(scene, model, worth))
    assert 0 < len(expected) < len(worth)
    other = replace(scene, device=replace(scene.device, threads=threads))
    np.testing.assert_array_equal(joined(without_losers(other, model, worth)), expected)


def test_one_seed_stays(stage: Stage) -> None:
    scene, model = stage()
    found = without_losers(scene, model, np.full(len(model.layout), 1e6))
    assert len(found.layout) == 1
    assert len(joined(found)) == 1
