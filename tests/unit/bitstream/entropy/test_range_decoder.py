"""The native range decoder against constriction's: the same symbols, the same payloads refused."""

from __future__ import annotations

import constriction
import numpy as np
import pytest
from examples import examples
from frequency_tables import (
    MAX_MAGNITUDE,
    TABLES,
    escape_model,
    frequency_tables,
    uniform_model,
    zero_centred_model,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from symbols import SymbolReader

from sgicodec.errors import CorruptStreamError

COUNT = 40


def decoded(payload: bytes, tables: list[int]) -> list[int] | None:
    """Runs of COUNT symbols, None where the payload does not decode."""
    reader, found = SymbolReader(payload), []
    for table in tables:
        try:
            found += reader.read(np.full(COUNT, table, np.int16)).tolist()
        except CorruptStreamError:
            return None
    return [*found, int(reader.ends)]


def decoded_by_constriction(payload: bytes, tables: list[int]) -> list[int] | None:
    words = np.frombuffer(payload + bytes(-len(payload) % 4), ">u4").astype(np.uint32)
    decoder, found = constriction.stream.queue.RangeDecoder(words), []
    for table in tables:
        support = frequency_tables().support[table]
        try:
            run = decoder.decode(zero_centred_model(table), COUNT)
            values = run - support
            escapes = np.flatnonzero(run == 2 * support + 1)
            exponents = decoder.decode(escape_model(), len(escapes)) if len(escapes) else np.zeros(0, np.int32)
            mantissas = np.zeros(len(escapes), np.int64)
            for e in np.unique(exponents):
                for piece in (max(e - 16, 0), min(e, 16)) if e else ():
                    raw = decoder.decode(uniform_model(int(piece)), int((exponents == e).sum())) if piece else 0
                    mantissas[exponents == e] = mantissas[exponents == e] << piece | raw
            signs = decoder.decode(uniform_model(1), len(escapes)) if len(escapes) else 0
        except AssertionError:  # what constriction raises
            return None
        magnitudes = mantissas + (1 << exponents.astype(np.int64)) + support
        if len(escapes) and magnitudes.max() > MAX_MAGNITUDE:
            return None
        values[escapes] = np.where(signs, -magnitudes, magnitudes)
        found += values.tolist()
    return [*found, int(decoder.maybe_exhausted())]


@settings(max_examples=examples(300))
@given(st.binary(max_size=200), st.lists(st.integers(0, TABLES - 1), min_size=1, max_size=6))
def test_any_bytes_mean_the_same(payload: bytes, tables: list[int]) -> None:
    payload = payload.rstrip(b"\0")  # such bytes say nothing, and are refused
    assert decoded(payload, tables) == decoded_by_constriction(payload, tables)


@pytest.mark.parametrize("symbols", [4, 10, 200, 1024])
def test_models_of_every_size(symbols: int) -> None:
    """Few symbols are searched from the first, many from a table."""
    support = frequency_tables().support
    table = int(np.argmin(np.abs(2 * support + 2 - symbols)))
    index = np.random.default_rng(symbols).integers(0, 2 * support[table] + 1, 1000).astype(np.int32)  # no escapes
    encoder = constriction.stream.queue.RangeEncoder()
    encoder.encode(index, zero_centred_model(table))
    reader = SymbolReader(encoder.get_compressed().astype(">u4").tobytes().rstrip(b"\0"))
    np.testing.assert_array_equal(reader.read(np.full(len(index), table, np.int16)), index - support[table])
