import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from sgicodec._native import SymbolReader
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.parts.arrays import write_base, write_signs, write_weights
from sgicodec.errors import CorruptStreamError

integers = st.one_of(st.integers(-3, 3), st.integers(-300, 300), st.integers(-100_000, 100_000))
tensors = hnp.arrays(np.int32, hnp.array_shapes(max_dims=3, max_side=9), elements=integers)
planes = hnp.arrays(np.int32, st.tuples(st.integers(1, 4), st.integers(1, 9), st.integers(1, 9)), elements=integers)


@given(tensors)
def test_weights_round_trip(weights: np.ndarray) -> None:
    writer = SymbolWriter()
    write_weights(writer, weights, weights.shape)
    reader = SymbolReader(writer.finish())
    assert np.array_equal(reader.read_weights(weights.size), weights.reshape(-1))
    reader.finish()


@given(st.lists(st.lists(st.integers(0, 1), max_size=40), min_size=1, max_size=5))
def test_signs_round_trip(levels: list[list[int]]) -> None:
    counts = [len(level) for level in levels]
    bits = [bit for level in levels for bit in level]
    writer = SymbolWriter()
    write_signs(writer, bits, counts)
    reader = SymbolReader(writer.finish())
    assert reader.read_signs(counts).tolist() == bits
    reader.finish()


@given(planes)
def test_base_round_trip(base: np.ndarray) -> None:
    writer = SymbolWriter()
    write_base(writer, base, base.shape)
    reader = SymbolReader(writer.finish())
    assert np.array_equal(reader.read_base(*base.shape), base)
    reader.finish()


def reference_plane(error: np.ndarray, predictor: int) -> np.ndarray:
    """docs/format.md, section "Base layer", one value at a time."""
    plane = np.zeros_like(error)
    for i in range(error.shape[0]):
        for j in range(error.shape[1]):
            west = int(plane[i, j - 1]) if j else int(plane[i - 1, j]) if i else 0
            north = int(plane[i - 1, j]) if i else west
            corner = int(plane[i - 1, j - 1]) if i and j else west if i == 0 else north
            median = sorted([west, north, west + north - corner])[1]
            guess = [west, north, (west + north) // 2, (2 * median + west + north + 2) // 4][predictor]
            plane[i, j] = guess + error[i, j]
    return plane


@pytest.mark.parametrize("predictor", range(4))
@pytest.mark.parametrize("shape", [(1, 1), (1, 6), (6, 1), (5, 7), (7, 4)])
def test_predictors_are_those_of_the_format(predictor: int, shape: tuple[int, int]) -> None:
    error = np.random.default_rng(8).integers(-20, 20, shape)
    writer = SymbolWriter()  # the part written by hand, with the predictor under test
    writer.code_int(predictor, 2)
    writer.code_int(50, 7)
    writer.code(error, np.full(shape, 50))
    decoded = SymbolReader(writer.finish()).read_base(1, *shape)
    assert np.array_equal(decoded[0], reference_plane(error, predictor))


def test_channels_are_predicted_from_errors_in_eighths() -> None:
    rests = np.random.default_rng(9).integers(-20, 20, (3, 4, 5))
    weights = [[], [3], [-8, 7]]
    writer = SymbolWriter()
    for channel in range(3):
        writer.code_int(0, 2)
        writer.code_bits([weight + 8 for weight in weights[channel]], 4)
        writer.code_int(50, 7)
        writer.code(rests[channel], np.full((4, 5), 50))
    decoded = SymbolReader(writer.finish()).read_base(3, 4, 5)
    errors = [rests[0]]
    errors.append(rests[1] + (3 * errors[0] + 4) // 8)
    errors.append(rests[2] + (-8 * errors[0] + 7 * errors[1] + 4) // 8)
    assert np.array_equal(decoded, [reference_plane(error, 0) for error in errors])


def test_values_that_grow_beyond_the_cap_are_corrupt() -> None:
    writer = SymbolWriter()
    writer.code_int(0, 2)
    writer.code_int(0, 7)
    writer.code(np.full((1, 3), 2**19), np.zeros((1, 3)))
    with pytest.raises(CorruptStreamError, match="base layer"):
        SymbolReader(writer.finish()).read_base(1, 1, 3)
