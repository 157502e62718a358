"""What is written against the native reader, and against one from docs/format.md that shares no code with either."""

import zlib
from collections.abc import Callable
from contextlib import suppress

import constriction
import numpy as np
import pytest
from examples import examples
from frequency_tables import MAX_MAGNITUDE, TABLES, TOTAL, frequency_tables, uniform_model, zero_centred_model
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from reference_decoder import ROUNDING, Bits
from symbols import SymbolReader, SymbolWriter

from sgicodec.errors import CorruptStreamError, LimitError


def crc_of(symbols: NDArray[np.int_]) -> int:
    return zlib.crc32(b"".join(int(n).to_bytes(4, "little", signed=True) for n in symbols))


def test_constriction_writes_the_same() -> None:
    """Every symbol of every table, in an order that makes long carries; then fields of every width."""
    rng, frequencies = np.random.default_rng(4), frequency_tables().of_table
    for table in range(TABLES):
        support = int(frequency_tables().support[table])
        symbols = rng.permutation(np.concatenate([np.arange(-support, support + 1), np.full(3000, -support)]))
        assert frequencies[table].min() > 0
        writer, coder = SymbolWriter(), constriction.stream.queue.RangeEncoder()
        writer.code(symbols, np.full(symbols.shape, table))
        coder.encode((symbols + support).astype(np.int32), zero_centred_model(table))
        for bits in range(1, 17):
            fields = rng.integers(0, 1 << bits, 50)
            writer.code_bits(fields, bits)
            coder.encode(fields.astype(np.int32), uniform_model(bits))
        high, low = divmod(writer.crc, 1 << 16)
        coder.encode(np.array([high, low], np.int32), uniform_model(16))
        assert writer.finish() == coder.get_compressed().astype(">u4").tobytes().rstrip(b"\0")


def test_the_reference_decoder_reads_zero_centred_symbols() -> None:
    rng = np.random.default_rng(3)
    tables = rng.integers(0, TABLES, 3000)
    support = frequency_tables().support[tables]
    symbols = np.clip(np.rint(rng.normal(0, support / 3)), -support, support).astype(int)  # no escapes
    writer = SymbolWriter()
    writer.code(symbols, tables)
    decoder = Bits(writer.finish())
    order = np.argsort(tables, kind="stable")
    for table, symbol, s in zip(tables[order], symbols[order], support[order], strict=True):
        assert decoder.decode(frequency_tables().of_table[table].tolist()) - s == symbol
    high, low = (decoder.decode([TOTAL >> 16] * 65536) for _ in range(2))
    assert high << 16 | low == crc_of(symbols)


def test_the_reference_decoder_reads_escapes() -> None:
    writer = SymbolWriter()
    writer.code([0, -9, 1, 5, 2], [0] * 5)  # table 0 covers −1 … 1
    decoder = Bits(writer.finish())
    frequencies = frequency_tables().of_table[0].tolist()
    assert [decoder.decode(frequencies) for _ in range(5)] == [1, 3, 2, 3, 3]
    unary = [TOTAL >> e for e in range(1, 21)] + [TOTAL >> 20]
    assert [decoder.decode(unary) for _ in range(3)] == [3, 2, 0]  # 9 − 2 = 7 = 8 − 1, 5 − 2 = 3 = 4 − 1, 0
    assert decoder.decode([TOTAL >> 2] * 4) == 0  # mantissas by ascending exponent
    assert decoder.decode([TOTAL >> 3] * 8) == 0
    assert [decoder.decode([TOTAL >> 1] * 2) for _ in range(3)] == [1, 0, 0]


symbols_and_tables = st.lists(
    st.tuples(
        st.one_of(st.integers(-4, 4), st.integers(-600, 600), st.integers(-MAX_MAGNITUDE, MAX_MAGNITUDE)),
        st.integers(0, TABLES - 1),
    ),
    max_size=60,
)


@given(symbols_and_tables)
def test_zero_centred_round_trip(pairs: list[tuple[int, int]]) -> None:
    symbols, tables = [n for n, _ in pairs], [t for _, t in pairs]
    writer = SymbolWriter()
    writer.code(symbols, tables)
    reader = SymbolReader(writer.finish())
    assert reader.read(np.array(tables, np.int16)).tolist() == symbols
    reader.finish()
    assert (reader.crc, reader.count) == (writer.crc, writer.count)
    assert reader.bits == pytest.approx(writer.bits, rel=ROUNDING)


@pytest.mark.parametrize(
    ("read", "errors"),
    [
        (lambda reader: reader.read(np.arange(TABLES, dtype=np.int16)).shape == (TABLES,), (CorruptStreamError,)),
        (lambda reader: reader.read_positions((300, 200), 50) is not None, (CorruptStreamError, LimitError)),
        (lambda reader: reader.read_tree((300, 200), 50) is not None, (CorruptStreamError, LimitError)),
    ],
    ids=["symbols", "positions", "tree"],
)
@settings(max_examples=examples(200))
@given(st.binary(max_size=60))
def test_any_bytes_decode_or_are_corrupt(
    read: Callable[[SymbolReader], bool], errors: tuple[type[Exception], ...], data: bytes
) -> None:
    with suppress(*errors):
        reader = SymbolReader(data)
        assert read(reader)
        reader.finish()


@pytest.mark.parametrize(
    ("method", "arguments"),
    [
        ("code", ([MAX_MAGNITUDE + 1], [0])),
        ("code", ([0], [TABLES])),
        ("code", ([0], [-1])),
        ("code", ([0, 0], [0])),
        ("code_bits", ([4], 2)),
        ("code_bits", ([0], 33)),
        ("code_weights", (np.array([1 << 32]),)),
    ],
)
def test_a_writer_refuses_what_cannot_be_coded(method: str, arguments: tuple[object, ...]) -> None:
    with pytest.raises(ValueError, match=r"exceeds|outside|for each|fit|fields"):
        getattr(SymbolWriter(), method)(*arguments)


def test_flags_of_every_probability() -> None:
    """P(1) in 2^-16: written, and read natively and from the page."""
    ones = np.tile(np.arange(1, 1 << 16), 2).astype(np.int32)
    bits = (np.arange(len(ones)) >= len(ones) // 2).astype(np.int32)
    order = np.argsort(ones, kind="stable")
    ones, bits = ones[order], bits[order]
    writer = SymbolWriter()
    writer.flags(bits, ones, np.array([7, -8], np.int32))
    content = -np.log2(np.where(bits, ones, 65536 - ones) / 65536).sum()
    assert writer.bits == pytest.approx(content, rel=ROUNDING)
    payload = writer.finish()
    assert (writer.count, writer.crc) == (3, crc_of(np.array([7, -8])))
    np.testing.assert_array_equal(SymbolReader(payload).read_flags(ones), bits)
    reference = Bits(payload)
    assert [reference.decode([TOTAL - 256 * int(one), 256 * int(one)]) for one in ones] == bits.tolist()
