"""The native range decoder against constriction's: the same symbols, the same payloads refused."""

from __future__ import annotations

import constriction
import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec._native import RangeDecoder, SymbolModels
from sgicodec.bitstream.entropy.symbol_models import ZERO_CENTRED
from sgicodec.bitstream.entropy.tables import TABLES, TOTAL

COUNT = 40


def decoded(payload: bytes, tables: list[int]) -> list[int] | None:
    """Runs of COUNT symbols, None where the payload does not decode."""
    decoder, found = RangeDecoder(payload), []
    for table in tables:
        start = np.full(TABLES + 1, COUNT, np.int64)
        start[: table + 1] = 0
        symbols = np.empty(COUNT, np.int32)
        if not decoder.decode(ZERO_CENTRED.reading, start, symbols):
            return None
        found += symbols.tolist()
    return [*found, int(decoder.maybe_exhausted())]


def decoded_by_constriction(payload: bytes, tables: list[int]) -> list[int] | None:
    words = np.frombuffer(payload + bytes(-len(payload) % 4), ">u4").astype(np.uint32)
    decoder, found = constriction.stream.queue.RangeDecoder(words), []
    for table in tables:
        try:
            found += decoder.decode(ZERO_CENTRED.writing(table), COUNT).tolist()
        except AssertionError:  # what constriction raises
            return None
    return [*found, int(decoder.maybe_exhausted())]


@settings(max_examples=examples(300))
@given(st.binary(max_size=200), st.lists(st.integers(0, TABLES - 1), min_size=1, max_size=6))
def test_any_bytes_mean_the_same(payload: bytes, tables: list[int]) -> None:
    assert decoded(payload, tables) == decoded_by_constriction(payload, tables)


@settings(max_examples=examples(100))
@given(st.integers(1, 16), st.lists(st.integers(0, (1 << 16) - 1), max_size=60))
def test_equally_likely_values(bits: int, values: list[int]) -> None:
    values = [value >> 16 - bits for value in values]
    encoder = constriction.stream.queue.RangeEncoder()
    encoder.encode(np.array(values, np.int32), constriction.stream.model.Uniform(1 << bits))
    decoder, found = RangeDecoder(encoder.get_compressed().astype(">u4").tobytes()), np.empty(len(values), np.int32)
    assert decoder.decode_uniform(bits, found)
    assert found.tolist() == values
    assert decoder.maybe_exhausted()


@pytest.mark.parametrize("size", [2, 8, 9, 300])
def test_models_of_every_size(size: int) -> None:
    """Few symbols are searched from the first, many from a table; those of frequency 0 are not counted."""
    rng = np.random.default_rng(size)
    frequency = np.append(rng.integers(1, TOTAL // size, size - 1), 0)
    frequency[-1] = TOTAL - frequency.sum()
    symbols = rng.integers(0, size, 1000).astype(np.int32)
    encoder = constriction.stream.queue.RangeEncoder()
    encoder.encode(symbols, constriction.stream.model.Categorical((frequency - 1).astype(float), perfect=False))
    payload = encoder.get_compressed().astype(">u4").tobytes()
    with_zeros = np.insert(frequency, [0, 1, size], 0)
    models = SymbolModels(with_zeros, np.array([0, len(with_zeros)]))
    found = np.empty(len(symbols), np.int32)
    assert RangeDecoder(payload).decode(models, np.array([0, len(symbols)]), found)
    np.testing.assert_array_equal(found, symbols)


@pytest.mark.parametrize(
    ("frequency", "start"),
    [([TOTAL - 1], [0, 1]), ([TOTAL + 1, -1], [0, 2]), ([TOTAL], [0, 2]), ([TOTAL], [0, 0, 1]), ([TOTAL], [-1, 1])],
)
def test_models_that_are_none(frequency: list[int], start: list[int]) -> None:
    with pytest.raises(ValueError, match=r"model|frequency"):
        SymbolModels(np.array(frequency), np.array(start))
