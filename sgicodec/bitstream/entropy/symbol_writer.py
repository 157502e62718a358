"""Entropy coding: the symbol writer. Its other direction, which reads, is native/bitstream/symbol_reader.cpp.

All parts of a tile share one range coder (ending one costs about four bytes). What a part cost is known exactly from
the frequencies: `writer.bits`.

The coder is constriction's range coder (Bamler 2022; Pasco 1976) with 32-bit words, 64-bit state and 24-bit
probabilities; docs/format.md specifies it to the bit.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgicodec.bitstream.entropy.symbol_groups import IntArray, as_keys, as_values, groups
from sgicodec.bitstream.entropy.symbol_models import (
    constriction,
    escape_model,
    uniform_model,
    zero_centred_model,
)
from sgicodec.bitstream.entropy.tables import (
    MAX_MAGNITUDE,
    TABLES,
    escape_bits,
    escape_exponent,
    frequency_tables,
)
from sgicodec.errors import UsageError
from sgicodec.model.distinct import distinct

__all__ = ["IntArray", "SymbolWriter", "range_coded"]

_PRECISION = 24
"""Bits of a probability."""
_UNIFORM_BITS = 16
"""Widest field that is coded in one piece; wider ones go in two."""


class SymbolWriter:
    """Writes a payload."""

    def __init__(self) -> None:
        self.count = 0
        """Values written so far."""
        self.crc = 0
        """CRC-32 of all values so far, in coding order, each as little-endian int32."""
        self.bits: dict[str, float] = {}
        """Information content of each part so far; the sum is the payload but for its last four bytes."""
        self._part = "rest"
        self._coder = constriction().stream.queue.RangeEncoder()

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Books what is written inside the block to part `name`; blocks nest, and a name may come back."""
        outer, self._part = self._part, name
        try:
            yield
        finally:
            self._part = outer

    def code(self, symbols: ArrayLike, tables: ArrayLike) -> None:
        """Zero-centred integers, each with its own table index; any shape, that of `tables`.

        In the stream the symbols are ordered by table index, equal indices by position; magnitudes beyond a
        table's support follow in order of position. Raises UsageError for a magnitude above MAX_MAGNITUDE or
        a bad index.
        """
        table = as_keys(tables, TABLES)
        values = as_values(symbols, table.size)
        if values.size and int(np.abs(values).max()) > MAX_MAGNITUDE:
            raise UsageError(f"entropy: a symbol exceeds ±{MAX_MAGNITUDE}; use a larger step")
        family = frequency_tables()
        order, start = groups(table, TABLES)
        support = family.support[table]
        escapes = np.abs(values) > support
        index = np.where(escapes, 2 * support + 1, values + support)
        self._ingroups(index[order].astype(np.int32), start, zero_centred_model)
        bits = float(family.symbol_bits[family.start[table] + index].sum())
        if escapes.any():
            bits += self._escape(values[escapes], support[escapes])
        self._record(values, bits)

    def code_bits(self, values: ArrayLike, n_bits: int) -> None:
        """Equally likely integers of `n_bits` (0 to 32) bits each."""
        if not 0 <= n_bits <= 32:
            raise UsageError(f"entropy: fields of {n_bits} bits; at most 32 are possible")
        given = np.asarray(values, np.int64).reshape(-1)
        if given.size and not 0 <= int(given.min()) <= int(given.max()) < 1 << n_bits:
            raise UsageError(f"entropy: a value does not fit into {n_bits} bits")
        self._uniform(given, n_bits)
        self._record(given, float(n_bits * given.size))

    def code_int(self, value: int, n_bits: int) -> None:
        """One equally likely integer of `n_bits` bits."""
        self.code_bits([value], n_bits)

    def flags(self, bits: IntArray, ones: IntArray, symbols: IntArray, content: float) -> None:
        """Codes bits [n] that are 1 with probabilities ones [n] / 2^16, and books the `symbols` that they spell."""
        _encode_bits(self._coder, bits, ones)
        self._record(symbols, content)

    def finish(self) -> bytes:
        """Appends the CRC of all symbols and returns the payload."""
        crc = self.crc
        with self.part("check"):
            self.code_int(crc, 32)
        self.crc = crc  # of the symbols, not of their check
        return _payload(self._coder)

    def _record(self, values: NDArray[np.integer], bits: float) -> None:
        self.count += values.size
        self.crc = zlib.crc32(np.ascontiguousarray(values, "<i4").data, self.crc)
        self.bits[self._part] = self.bits.get(self._part, 0.0) + bits

    def _escape(self, values: NDArray[np.int64], support: IntArray) -> float:
        """Values beyond ±support: exponents, then mantissas by ascending exponent, then signs. Their information
        content.
        """
        excess = np.abs(values) - support - 1
        exponent = escape_exponent(excess).astype(np.int32)
        self._run(exponent, escape_model())
        for e in distinct(exponent).tolist():
            where = np.flatnonzero(exponent == e)
            self._uniform((excess[where] + 1 - (1 << e)).astype(np.int64), e)
        self._uniform((values < 0).astype(np.int64), 1)
        return float(escape_bits(excess).sum())

    def _uniform(self, values: NDArray[np.int64], n_bits: int) -> None:
        if n_bits > _UNIFORM_BITS:
            self._uniform(values >> _UNIFORM_BITS, n_bits - _UNIFORM_BITS)
            self._uniform(values & 0xFFFF, _UNIFORM_BITS)
        elif n_bits and values.size:
            self._run(values.astype(np.int32), uniform_model(n_bits))

    def _ingroups(self, index: IntArray, start: NDArray[np.intp], models: Callable[[int], Any]) -> None:
        """Codes symbol indices that are ordered by key, those of `key` from start[key] on, each run under its model."""
        for key, (begin, end) in enumerate(pairwise(start.tolist())):
            if begin < end:
                self._run(index[begin:end], models(key))

    def _run(self, index: IntArray, model: Any) -> None:
        """Codes symbol indices under one model of constriction."""
        try:
            self._coder.encode(np.ascontiguousarray(index), model)
        except BaseException as error:
            raise _not_a_panic(error) from error


def range_coded(bits: IntArray, ones: IntArray) -> bytes:
    """The payload of bits [n] alone that are 1 with probabilities ones [n] / 2^16."""
    coder = constriction().stream.queue.RangeEncoder()
    _encode_bits(coder, bits, ones)
    return _payload(coder)


def _encode_bits(coder: Any, bits: IntArray, ones: IntArray) -> None:
    model = constriction().stream.model.Bernoulli(perfect=False)
    coder.encode(bits, model, _probabilities()[ones])


@cache
def _probabilities() -> NDArray[np.float64]:
    """What constriction is given for P(1) = index / 2^16. It takes floats: P(0) becomes the frequency
    1 + floor(P(0) (2^24 - 2)).
    """
    zero = (1 << _PRECISION) - (np.arange(1 << 16) << (_PRECISION - 16))
    return np.asarray(1 - (zero - 0.5) / ((1 << _PRECISION) - 2))


def _payload(coder: Any) -> bytes:
    """All words of a range coder, the most significant byte first: zero bytes at the end say nothing and are left
    out.
    """
    words: NDArray[np.uint32] = coder.get_compressed()
    return words.astype(">u4").tobytes().rstrip(b"\0")


def _not_a_panic(error: BaseException) -> BaseException:
    """What to raise instead of whatever constriction raised; its PanicException is not even an Exception."""
    if isinstance(error, KeyboardInterrupt | SystemExit | MemoryError):
        return error
    return RuntimeError(f"entropy: these symbols cannot be coded ({' '.join(str(error).split())})")
