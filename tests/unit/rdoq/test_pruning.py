"""Which seeds go, against dense sums in float64."""

import numpy as np
import pytest
from rough_models import stage

from sgicodec.raster.reference import rasterize_reference
from sgicodec.rdoq.objective import joined
from sgicodec.rdoq.pruning import without_pruned_seeds


@pytest.mark.parametrize("weighted", [False, True])
def test_each_goes_that_costs_less_than_its_price(weighted: bool) -> None:
    """One after the other, the faintest for their price first."""
    objective, model = stage(height=40, width=60, weighted=weighted)
    rng = np.random.default_rng(3)
    price = rng.uniform(0, 0.3, len(model.layout))
    means, covariances, colours = (array.astype(np.float64) for array in objective.gaussians(model))
    values = rasterize_reference(means, covariances, np.eye(len(means)), 60, 40)  # [N, H, W]
    residual = objective.picture - np.einsum("nc,nyx->cyx", colours, values)
    energy = (colours**2).sum(1) * np.sqrt(covariances[:, 0] * covariances[:, 2] - covariances[:, 1] ** 2)
    keep = np.ones(len(means), bool)
    for i in np.argsort(energy / price, kind="stable"):
        without = residual + colours[i][:, None, None] * values[i]
        weights = 1.0 if objective.weights is None else objective.weights
        change = np.sum(weights * (without**2 - residual**2))
        assert abs(change - price[i]) > 1e-4, "too close to tell: choose another seed for this test"
        if change < price[i]:
            keep[i], residual = False, without
    assert 5 < keep.sum() < len(keep) - 5
    found = without_pruned_seeds(objective, model, objective.residual(model), price)
    np.testing.assert_array_equal(joined(found), joined(model)[keep])
    np.testing.assert_array_equal(found.layout.corner, model.layout.corner[keep])
    last = without_pruned_seeds(objective, model, objective.residual(model), np.full(len(price), 1e6))
    assert len(last.layout) == 1
