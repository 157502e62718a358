import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from symbols import SymbolReader, SymbolWriter, write_base, write_signs, write_weights

from sgicodec.errors import CorruptStreamError

integers = st.one_of(st.integers(-3, 3), st.integers(-300, 300), st.integers(-100_000, 100_000))
tensors = hnp.arrays(np.int32, hnp.array_shapes(max_dims=3, max_side=9), elements=integers)
planes = hnp.arrays(np.int32, st.tuples(st.integers(1, 4), st.integers(1, 9), st.integers(1, 9)), elements=integers)


@given(tensors)
def test_weights_round_trip(weights: np.ndarray) -> None:
    writer = SymbolWriter()
    write_weights(writer, weights)
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
    write_base(writer, base)
    reader = SymbolReader(writer.finish())
    assert np.array_equal(reader.read_base(*base.shape), base)
    reader.finish()


@pytest.mark.parametrize("shape", [(1, 1), (1, 6), (6, 1), (5, 7), (7, 4)])
def test_values_are_predicted_as_the_format_says(shape: tuple[int, int]) -> None:
    """docs/format.md, section "Base layer", one value at a time."""
    errors = np.random.default_rng(8).integers(-20, 20, (3, *shape))
    writer = SymbolWriter()
    for channel in errors:
        write_weights(writer, channel)
    planes = np.zeros_like(errors)
    for c, i, j in np.ndindex(*errors.shape):
        west = int(planes[c, i, j - 1]) if j else int(planes[c, i - 1, j]) if i else 0
        north = int(planes[c, i - 1, j]) if i else west
        planes[c, i, j] = (west + north) // 2 + errors[c, i, j]
    assert np.array_equal(SymbolReader(writer.finish()).read_base(3, *shape), planes)


def test_values_that_grow_beyond_the_cap_are_corrupt() -> None:
    writer = SymbolWriter()
    write_weights(writer, np.full((1, 3), 2**19))
    with pytest.raises(CorruptStreamError, match="base layer"):
        SymbolReader(writer.finish()).read_base(1, 1, 3)
