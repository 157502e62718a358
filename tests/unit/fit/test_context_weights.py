"""The weights of MLP_p: floats of a fit, and the integers that a stream holds."""

import numpy as np

from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.fit.context_weights import FINER, WEIGHT_SHIFT, ContextWeights, float_weights
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec


def test_weights_that_train_become_the_nearest_integers() -> None:
    weights = ContextWeights(paper_spec(1, 2, 6), (120, 200), np.random.default_rng(1))
    network = weights.integers()
    assert set(weights.trained()) == {f"context.{name}" for name in ("first", "rest", "tables")}
    flat = np.concatenate([array.reshape(-1) for array in network.arrays]) * 2.0**-WEIGHT_SHIFT
    off = np.abs(flat - np.concatenate([weights.first, weights.rest]))
    assert 0 < off.max() <= 0.5 * 2.0**-WEIGHT_SHIFT


def test_a_fit_sees_the_shipped_weights_with_finer_steps() -> None:
    networks = load_prior(default_spec(3))
    (first, rest), (_, exact) = float_weights(networks), float_weights(networks, 0.0)
    assert first.size == sum(network.w1.size for network in networks)
    refined = np.flatnonzero(rest != exact)
    np.testing.assert_allclose((exact - rest)[refined], FINER, rtol=1e-6)
    ends = np.cumsum([network.b1.size + network.w2.size + network.b2.size for network in networks])
    assert refined.tolist() == (ends - 1).tolist()
