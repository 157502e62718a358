"""Entropy coding: the symbol coder, which writes symbols in one direction and reads them in the other.

A part of the format is coded by one function that calls the same methods on either coder: given values, a
`SymbolWriter` codes and returns them; given None, a `SymbolReader` decodes and returns them. Encoder and
decoder can therefore not drift apart.

    def code_sizes(coder, sizes, count):
        return coder.code_bits(sizes, 4, count)

All parts of a tile share one range coder (ending one costs about four bytes). What a part cost is known
exactly from the frequencies, in both directions: `coder.bits`.

The coder is constriction's range coder (Bamler 2022; Pasco 1976) with 32-bit words, 64-bit state and 24-bit
probabilities; docs/format.md specifies it to the bit. Constriction writes; native code reads, without Python's lock.
"""

from __future__ import annotations

import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.alphabets import Alphabets
from sgicodec.bitstream.entropy.symbol_groups import IntArray, as_keys, as_values, groups
from sgicodec.bitstream.entropy.symbol_models import (
    ZERO_CENTRED,
    CategoricalModels,
    SymbolModels,
    constriction,
    escape_alphabet,
    uniform_model,
    zero_centred_tables,
)
from sgicodec.bitstream.entropy.tables import (
    MAX_MAGNITUDE,
    TABLES,
    escape_bits,
    escape_exponent,
    frequency_tables,
)
from sgicodec.errors import CorruptStreamError, UsageError

__all__ = ["IntArray", "SymbolCoder", "SymbolReader", "SymbolWriter", "require_sound"]

_PRECISION = 24
"""Bits of a probability."""
_UNIFORM_BITS = 16
"""Widest field that is coded in one piece; wider ones go in two."""


class SymbolCoder(ABC):
    """What writing and reading share. Values are None when reading; counts and shapes always come from the
    caller, which thereby bounds everything that is allocated.
    """

    def __init__(self) -> None:
        self.count = 0
        """Values coded so far."""
        self.crc = 0
        """CRC-32 of all values so far, in coding order, each as little-endian int32."""
        self.bits: dict[str, float] = {}
        """Information content of each part so far; the sum is the payload but for its last four bytes."""
        self._part = "rest"

    @property
    def current(self) -> str:
        """The part that is being coded."""
        return self._part

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Books what is coded inside the block to part `name`; blocks nest, and a name may come back."""
        outer, self._part = self._part, name
        try:
            yield
        finally:
            self._part = outer

    def code(self, symbols: ArrayLike | None, tables: ArrayLike) -> IntArray:
        """Zero-centred integers, each with its own table index; any shape, that of `tables`.

        In the stream the symbols are ordered by table index, equal indices by position; magnitudes beyond a
        table's support follow in order of position. Raises UsageError for a magnitude above MAX_MAGNITUDE or
        a bad index when writing, CorruptStreamError when reading.
        """
        shape = np.shape(tables)
        table = as_keys(tables, TABLES)
        values = None if symbols is None else as_values(symbols, table.size)
        if values is not None and values.size and int(np.abs(values).max()) > MAX_MAGNITUDE:
            raise UsageError(f"entropy: a symbol exceeds ±{MAX_MAGNITUDE}; use a larger step")
        coded, bits = self._zero_centred(values, table)
        self._record(coded, bits)
        return coded.reshape(shape)

    def code_categorical(
        self, symbols: ArrayLike | None, alphabets: Alphabets | NDArray[np.int64], contexts: ArrayLike
    ) -> IntArray:
        """Symbols 0 … A−1; symbol i under row `contexts[i]` of `alphabets`, or of the frequencies of some.

        Order in the stream as for `code`, by context. Raises UsageError for a symbol that cannot occur or a
        bad row.
        """
        if not isinstance(alphabets, Alphabets):
            alphabets = Alphabets(alphabets)
        shape, rows = np.shape(contexts), len(alphabets.frequencies)
        context = as_keys(contexts, rows)
        order, start = groups(context, rows)
        index = None
        if symbols is not None:
            values, size = as_values(symbols, context.size), alphabets.frequencies.shape[1]
            if np.any((values < 0) | (values >= size)):
                raise UsageError(f"entropy: a symbol is outside 0..{size - 1}")
            if np.any(alphabets.frequencies[context, values] == 0):
                raise UsageError("entropy: a symbol has frequency 0 in its context")
            index = alphabets.rank[context, values][order]
        index = self._ingroups(index, start, CategoricalModels(alphabets))
        coded = np.empty(context.size, np.int32)
        bits = _native.ungroup_categorical(index, order, context, alphabets.symbol, alphabets.bits, coded)
        self._record(coded, bits)
        return coded.reshape(shape)

    def code_bits(self, values: ArrayLike | None, n_bits: int, count: int) -> NDArray[np.int64]:
        """`count` equally likely integers of `n_bits` (0 to 32) bits each."""
        if not 0 <= n_bits <= 32:
            raise UsageError(f"entropy: fields of {n_bits} bits; at most 32 are possible")
        given = None if values is None else as_values(values, count)
        if given is not None and given.size and not 0 <= int(given.min()) <= int(given.max()) < 1 << n_bits:
            raise UsageError(f"entropy: a value does not fit into {n_bits} bits")
        coded = self._uniform(given, n_bits, count)
        self._record(coded, float(n_bits * count))
        return coded

    def code_int(self, value: int | None, n_bits: int) -> int:
        """One equally likely integer of `n_bits` bits."""
        return int(self.code_bits(None if value is None else [value], n_bits, 1)[0])

    @abstractmethod
    def _zero_centred(self, values: NDArray[np.int64] | None, table: NDArray[np.int16]) -> tuple[IntArray, float]:
        """Codes zero-centred symbols as `code` says; with them comes their information content."""

    @abstractmethod
    def _ingroups(self, index: IntArray | None, start: NDArray[np.int64], models: SymbolModels) -> IntArray:
        """Codes symbol indices that are ordered by key, those of `key` from start[key] on, each run under its model."""

    @abstractmethod
    def _equally_likely(self, values: IntArray | None, n_bits: int, count: int) -> IntArray:
        """Codes `count` values of 1 to _UNIFORM_BITS bits."""

    def _record(self, values: NDArray[np.integer], bits: float) -> None:
        self._count(values)
        self._book(bits)

    def _count(self, values: NDArray[np.integer]) -> None:
        self.count += values.size
        self.crc = zlib.crc32(np.ascontiguousarray(values, "<i4").data, self.crc)

    def _book(self, bits: float) -> None:
        self.bits[self._part] = self.bits.get(self._part, 0.0) + bits

    def _uniform(self, values: NDArray[np.int64] | None, n_bits: int, count: int) -> NDArray[np.int64]:
        if n_bits > _UNIFORM_BITS:
            high = self._uniform(None if values is None else values >> _UNIFORM_BITS, n_bits - _UNIFORM_BITS, count)
            low = self._uniform(None if values is None else values & 0xFFFF, _UNIFORM_BITS, count)
            return high << _UNIFORM_BITS | low
        if n_bits == 0 or count == 0:
            return np.zeros(count, np.int64)
        index = None if values is None else values.astype(np.int32)
        return self._equally_likely(index, n_bits, count).astype(np.int64)


class SymbolWriter(SymbolCoder):
    """Writes a payload."""

    def __init__(self) -> None:
        super().__init__()
        self._coder = constriction().stream.queue.RangeEncoder()

    def finish(self) -> bytes:
        """Appends the CRC of all symbols and returns the payload: words with the most significant byte first,
        so that zero bytes at the end say nothing and are left out.
        """
        crc = self.crc
        with self.part("check"):
            self.code_int(crc, 32)
        self.crc = crc  # of the symbols, not of their check
        words: NDArray[np.uint32] = self._coder.get_compressed()
        return words.astype(">u4").tobytes().rstrip(b"\0")

    def flags(self, bits: IntArray, ones: IntArray, symbols: IntArray, content: float) -> None:
        """Codes bits [n] that are 1 with probabilities ones [n] / 2^16, and books the `symbols` that they spell."""
        zero = (1 << _PRECISION) - (ones.astype(np.int64) << (_PRECISION - 16))
        model = constriction().stream.model.Bernoulli(perfect=False)
        # Constriction takes floats: P(0) becomes the frequency 1 + floor(P(0) (2^24 - 2)).
        self._coder.encode(bits, model, 1 - (zero - 0.5) / ((1 << _PRECISION) - 2))
        self._record(symbols, content)

    def _zero_centred(self, values: NDArray[np.int64] | None, table: NDArray[np.int16]) -> tuple[IntArray, float]:
        if values is None:
            raise UsageError("entropy: a writer needs values")
        family = frequency_tables()
        order, start = groups(table, TABLES)
        support = family.support[table]
        index = np.where(np.abs(values) <= support, values + support, 2 * support + 1)[order].astype(np.int32)
        self._ingroups(index, start, ZERO_CENTRED)
        coded = np.empty(table.size, np.int32)
        tables_of = (family.support, family.start, family.symbol_bits)
        bits, escapes = _native.ungroup_symbols(index, order, table, *tables_of, coded)
        if escapes:
            where = np.flatnonzero(coded > support)
            coded[where] = values[where]
            bits += self._escape(values[where], support[where])
        return coded, bits

    def _escape(self, values: NDArray[np.int64], support: IntArray) -> float:
        """Values beyond ±support: exponents, then mantissas by ascending exponent, then signs. Their information
        content.
        """
        excess = np.abs(values) - support - 1
        exponent = escape_exponent(excess).astype(np.int32)
        self._ingroups(exponent, np.array([0, exponent.size], np.int64), CategoricalModels(escape_alphabet()))
        for e in np.unique(exponent).tolist():
            where = np.flatnonzero(exponent == e)
            self._uniform((excess[where] + 1 - (1 << e)).astype(np.int64), e, where.size)
        self._uniform((values < 0).astype(np.int64), 1, values.size)
        return float(escape_bits(excess).sum())

    def _ingroups(self, index: IntArray | None, start: NDArray[np.int64], models: SymbolModels) -> IntArray:
        if index is None:
            raise UsageError("entropy: a writer needs values")
        for key, (begin, end) in enumerate(pairwise(start.tolist())):
            if begin < end:
                self._run(index[begin:end], models.writing(key))
        return index

    def _equally_likely(self, values: IntArray | None, n_bits: int, count: int) -> IntArray:
        if values is None:
            raise UsageError("entropy: a writer needs values")
        self._run(values, uniform_model(n_bits))
        return values

    def _run(self, index: IntArray, model: Any) -> None:
        """Codes symbol indices under one model of constriction; None codes nothing."""
        if model is None:
            return
        try:
            self._coder.encode(np.ascontiguousarray(index), model)
        except BaseException as error:
            raise _not_a_panic(error, RuntimeError, "these symbols cannot be coded") from error


class SymbolReader(SymbolCoder):
    """Reads a payload. Values passed to it are ignored; pass None."""

    def __init__(self, payload: bytes) -> None:
        super().__init__()
        if payload[-1:] == b"\0":
            raise CorruptStreamError("entropy: the payload is padded with zero bytes; it was not written by an encoder")
        self._coder = _native.RangeDecoder(payload)

    def read(self, part: Callable[[_native.RangeDecoder], tuple[int, IntArray, list[float]]], names: list[str]) -> None:
        """Lets a native function read by itself: it returns whether that is sound (`require_sound`), all symbols in
        coding order, and the information content of each of the parts `names`.
        """
        reading, symbols, bits = part(self._coder)
        require_sound(reading)
        self._count(symbols)
        for name, amount in zip(names, bits, strict=True):
            with self.part(name):
                self._book(amount)

    def finish(self) -> None:
        """Raises CorruptStreamError unless the symbols are those written and the payload ends with them."""
        crc = self.crc
        with self.part("check"):
            written = self.code_int(None, 32)
        self.crc = crc  # of the symbols, not of their check
        if written != crc:
            raise CorruptStreamError(
                f"entropy: decoded symbols have CRC {crc:08x}, the encoder's had {written:08x}; "
                "the payload is damaged, or decoder and encoder disagree about contexts"
            )
        if not self._coder.maybe_exhausted():
            raise CorruptStreamError("entropy: bytes are left over behind the last symbol")

    def _zero_centred(self, values: NDArray[np.int64] | None, table: NDArray[np.int16]) -> tuple[IntArray, float]:
        coded = np.empty(table.size, np.int32)
        reading, bits = _native.read_zero_centred(self._coder, zero_centred_tables(), table, coded)
        require_sound(reading)
        return coded, bits

    def _ingroups(self, index: IntArray | None, start: NDArray[np.int64], models: SymbolModels) -> IntArray:
        coded = np.empty(int(start[-1]), np.int32)
        return _sound(coded, self._coder.decode(models.reading, start, coded))

    def _equally_likely(self, values: IntArray | None, n_bits: int, count: int) -> IntArray:
        coded = np.empty(count, np.int32)
        return _sound(coded, self._coder.decode_uniform(n_bits, coded))


def _sound(coded: IntArray, decodes: bool) -> IntArray:
    require_sound(0 if decodes else 1)
    return coded


def require_sound(reading: int) -> None:
    """Raises CorruptStreamError unless native code read without a fault: 1 where the payload does not decode, 2 where a
    symbol is too large.
    """
    if reading == 1:
        raise CorruptStreamError("entropy: the payload does not decode; it is damaged")
    if reading == 2:
        raise CorruptStreamError(f"entropy: a symbol exceeds ±{MAX_MAGNITUDE}; the stream is damaged")


def _not_a_panic(error: BaseException, failure: type[Exception], message: str) -> BaseException:
    """What to raise instead of whatever constriction raised; its PanicException is not even an Exception."""
    if isinstance(error, KeyboardInterrupt | SystemExit | MemoryError):
        return error
    return failure(f"entropy: {message} ({' '.join(str(error).split())})")
