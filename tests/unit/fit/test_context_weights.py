"""The weights of MLP_p: floats of a fit, and the integers that a stream holds."""

import numpy as np

from sgicodec.fit.context_weights import WEIGHT_SHIFT, ContextWeights
from sgicodec.profiles.paper import paper_spec


def test_weights_that_train_become_the_nearest_integers() -> None:
    weights = ContextWeights(paper_spec(1, 2, 6), (120, 200), np.random.default_rng(1))
    network = weights.integers()
    assert set(weights.trained()) == {f"context.{name}" for name in ("first", "rest", "tables")}
    flat = np.concatenate([array.reshape(-1) for array in network.arrays]) * 2.0**-WEIGHT_SHIFT
    off = np.abs(flat - np.concatenate([weights.first, weights.rest]))
    assert 0 < off.max() <= 0.5 * 2.0**-WEIGHT_SHIFT
