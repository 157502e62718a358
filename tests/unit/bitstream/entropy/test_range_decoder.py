"""The native range decoder against constriction's: the same symbols, the same payloads refused."""

from __future__ import annotations

import constriction
import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec._native import SymbolReader
from sgicodec.bitstream.entropy.symbol_models import zero_centred_model
from sgicodec.bitstream.entropy.tables import TABLES, TOTAL, frequency_tables
from sgicodec.errors import CorruptStreamError

COUNT = 40
ROW = np.zeros(1, np.int16)


def decoded(payload: bytes, tables: list[int]) -> list[int] | None:
    """Runs of COUNT symbols, None where the payload does not decode."""
    reader, found = SymbolReader(payload), []
    for table in tables:
        try:
            found += reader.read_categorical(frequency_tables().frequencies(table)[None], ROW.repeat(COUNT)).tolist()
        except CorruptStreamError:
            return None
    return [*found, int(reader.ends)]


def decoded_by_constriction(payload: bytes, tables: list[int]) -> list[int] | None:
    words = np.frombuffer(payload + bytes(-len(payload) % 4), ">u4").astype(np.uint32)
    decoder, found = constriction.stream.queue.RangeDecoder(words), []
    for table in tables:
        try:
            found += decoder.decode(zero_centred_model(table), COUNT).tolist()
        except AssertionError:  # what constriction raises
            return None
    return [*found, int(decoder.maybe_exhausted())]


@settings(max_examples=examples(300))
@given(st.binary(max_size=200), st.lists(st.integers(0, TABLES - 1), min_size=1, max_size=6))
def test_any_bytes_mean_the_same(payload: bytes, tables: list[int]) -> None:
    payload = payload.rstrip(b"\0")  # such bytes say nothing, and are refused
    assert decoded(payload, tables) == decoded_by_constriction(payload, tables)


@pytest.mark.parametrize("size", [2, 8, 9, 300])
def test_models_of_every_size(size: int) -> None:
    """Few symbols are searched from the first, many from a table; those of frequency 0 do not occur."""
    rng = np.random.default_rng(size)
    frequency = np.append(rng.integers(1, TOTAL // size, size - 1), 0)
    frequency[-1] = TOTAL - frequency.sum()
    symbols = rng.integers(0, size, 1000).astype(np.int32)
    encoder = constriction.stream.queue.RangeEncoder()
    encoder.encode(symbols, constriction.stream.model.Categorical((frequency - 1).astype(float), perfect=False))
    reader = SymbolReader(encoder.get_compressed().astype(">u4").tobytes().rstrip(b"\0"))
    where = np.insert(np.ones(size, bool), [0, 1, size], False)
    with_zeros = np.zeros(len(where), np.int64)
    with_zeros[where] = frequency
    found = reader.read_categorical(with_zeros[None], ROW.repeat(len(symbols)))
    np.testing.assert_array_equal(found, np.flatnonzero(where)[symbols])
