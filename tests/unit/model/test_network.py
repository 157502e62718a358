"""MLP_p on every instruction set against integers of any size."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import ISAS

from sgicodec._native import HIDDEN_LIMIT, INPUT_LIMIT, evaluate_network
from sgicodec.errors import CorruptStreamError
from sgicodec.model.network import IntNetwork

INPUTS, HIDDEN, PREDICTED, GROUPS = 11, 7, 3, 2
OUTPUTS = 2 * PREDICTED + GROUPS


def network(seed: int, shift: int, size: int = 300) -> IntNetwork:
    rng = np.random.default_rng(seed)
    shapes = ((HIDDEN, INPUTS), (HIDDEN,), (OUTPUTS, HIDDEN), (OUTPUTS,))
    w1, b1, w2, b2 = (rng.integers(-size, size + 1, shape) for shape in shapes)
    return IntNetwork(w1, b1, w2, b2, shift, PREDICTED)


def products(net: IntNetwork, rows: np.ndarray) -> list[list[int]]:
    """docs/format.md, "MLP_p", as products of matrices of integers; >> rounds down."""
    x = np.clip(rows.astype(np.int64), -(2**13), 2**13)
    hidden = np.clip((x @ net.w1.T + 64 * net.b1) >> net.shift, 0, 2**15)
    y = hidden @ net.w2.T + 64 * net.b2
    means, others = y[:, : net.predicted] >> (net.shift - 2), (6 * y[:, net.predicted :]) >> (6 + net.shift)
    return np.concatenate([means, others], axis=1).tolist()


def predict(net: IntNetwork, rows: np.ndarray, isa: str) -> list[list[int]]:
    """By the library."""
    out = np.empty((len(rows), len(net.w2)), np.int64)
    evaluate_network(*net.arrays, net.shift, net.predicted, rows, isa, out)
    return out.tolist()


every_isa = pytest.mark.parametrize("isa", ISAS)

rows = st.lists(
    st.lists(st.one_of(st.integers(-200, 200), st.integers(-(2**15), 2**15 - 1)), min_size=INPUTS, max_size=INPUTS),
    min_size=1,
    max_size=4,
)


@every_isa
@given(rows, st.integers(0, 1000), st.integers(2, 20), st.sampled_from([3, 300, 2**20]))
def test_predictions_are_those_of_integers(isa: str, inputs: list[list[int]], seed: int, shift: int, size: int) -> None:
    net, x = network(seed, shift, size), np.array(inputs, np.int16)
    assert predict(net, x, isa) == products(net, x)


@every_isa
@pytest.mark.parametrize("shape", [(1, 1, 1), (44, 64, 5), (57, 100, 133), (30, 33, 32)])
def test_any_shape_and_number_of_rows(isa: str, shape: tuple[int, int, int]) -> None:
    """Rows of 16 bits that are parts of wider ones, as coding has them; more of them than a thread takes at once."""
    inputs, hidden, outputs = shape
    rng = np.random.default_rng(outputs)
    for size in (300, 2**18):
        weights = (
            rng.integers(-size, size + 1, part) for part in ((hidden, inputs), hidden, (outputs, hidden), outputs)
        )
        net = IntNetwork(*weights, 8, outputs // 2)
        for count in (0, 1, 6, 1100):
            x = rng.integers(-(2**15), 2**15, (count, inputs + 3)).astype(np.int16)[:, :inputs]
            assert predict(net, x, isa) == products(net, x)


@every_isa
@pytest.mark.parametrize("layer", ["w1", "w2"])
@pytest.mark.parametrize("beyond", [0, 1])
def test_sums_at_the_end_of_32_bits(isa: str, layer: str, beyond: int) -> None:
    """The largest weights whose sums have 32 bits, and one more."""
    limit, width = (INPUT_LIMIT, INPUTS) if layer == "w1" else (HIDDEN_LIMIT, HIDDEN)
    net = network(3, 2, 5)
    weights = np.zeros_like(getattr(net, layer))
    room = (2**31 - 1 - 64 * int(np.abs(net.b1 if layer == "w1" else net.b2).max())) // limit
    per_weight = [room // width] * width
    per_weight[0] += room - sum(per_weight) + beyond
    weights[0], weights[1] = per_weight, [-weight for weight in per_weight]
    if layer == "w2":
        net = replace(net, w1=np.full_like(net.w1, 100))
    net = replace(net, **{layer: weights})
    inputs = np.array([[2**13] * INPUTS, [-(2**13)] * INPUTS, [2**13 - 1] * INPUTS], np.int16)
    assert predict(net, inputs, isa) == products(net, inputs)


@every_isa
@pytest.mark.parametrize("weight", [-(2**15) - 1, -(2**15), 2**15 - 1, 2**15])
def test_weights_at_the_end_of_16_bits(isa: str, weight: int) -> None:
    net = network(4, 5, 3)
    w1, w2 = np.array(net.w1), np.array(net.w2)
    w1[2, 3] = w2[1, 2] = weight
    inputs = np.array([[1000] * INPUTS, [-1000] * INPUTS], np.int16)
    for changed in (replace(net, w1=w1), replace(net, w2=w2)):
        assert predict(changed, inputs, isa) == products(changed, inputs)


def test_weights_that_float64_could_not_sum_are_refused() -> None:
    net = network(0, 8)
    room = 2**53 // INPUT_LIMIT
    w1 = np.zeros_like(net.w1)
    w1[2, :2] = [-(room // 2), room // 2 - 100]
    replace(net, w1=w1)
    w1[2, 1] += 100
    with pytest.raises(CorruptStreamError, match="too large"):
        replace(net, w1=w1)
    w2 = np.zeros_like(net.w2)
    w2[5, 0] = 2**53 // (6 * HIDDEN_LIMIT) - 100
    replace(net, w2=w2)
    w2[5, 0] += 101
    with pytest.raises(CorruptStreamError, match="too large"):
        replace(net, w2=w2)
    for name, at, most in (("b1", 1, 2**53 // 64), ("b2", 3, 2**53 // (64 * 6))):
        bias = np.zeros_like(getattr(net, name))
        bias[at] = -most
        with pytest.raises(CorruptStreamError, match="too large"):
            replace(net, **{name: bias})
