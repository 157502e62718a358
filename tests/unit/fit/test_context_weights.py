"""The weights of MLP_p: floats that train, and the integers that a stream holds."""

import numpy as np
import pytest

from sgicodec.fit.context_weights import WEIGHT_SHIFT, ContextWeights
from sgicodec.model.network import DIFFERENCE_SHIFT, IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

specs = pytest.mark.parametrize("spec", [default_spec(3, prior=0), paper_spec(1, 2, 6)], ids=["default", "paper"])

UNIT = 2.0**-WEIGHT_SHIFT
SIZES = (30, 50)


def weights_of(spec: ModelSpec) -> ContextWeights:
    return ContextWeights(spec, SIZES, np.random.default_rng(1))


def assert_same(found: tuple[IntNetwork, ...], expected: tuple[IntNetwork, ...]) -> None:
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        for a, b in zip(one.arrays, other.arrays, strict=True):
            np.testing.assert_array_equal(a, b)


@specs
def test_frozen_weights_are_those_of_the_stream(spec: ModelSpec) -> None:
    weights = weights_of(spec)
    before, networks = weights.first.copy(), weights.integers()
    assert set(weights.trained()) == {f"context.{name}" for name in ("first", "rest", "tables")}
    weights.freeze()
    assert weights.trained() == {}
    assert 0 < np.abs(weights.first - before).max() <= 0.5 * UNIT
    assert_same(weights.integers(), networks)


@specs
def test_differences_are_added_in_their_own_unit(spec: ModelSpec) -> None:
    networks = weights_of(spec).integers()
    weights = weights_of(spec)
    weights.adapt(networks)
    assert_same(weights.integers(), networks)
    assert list(weights.trained()) == ["context.difference"]
    weights.trained()["context.difference"][:] = 2.2 * 2.0**-DIFFERENCE_SHIFT
    for changed, network in zip(weights.integers(), networks, strict=True):
        more = 2 << (network.shift - DIFFERENCE_SHIFT)
        np.testing.assert_array_equal(changed.w1, network.w1)
        np.testing.assert_array_equal(changed.b1, network.b1 + more)
        np.testing.assert_array_equal(changed.w2, network.w2 + more)
        np.testing.assert_array_equal(changed.b2, network.b2 + more)
