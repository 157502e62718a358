"""Probability models of symbols: the same frequencies for constriction, which writes, and native code, which reads."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from types import ModuleType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.alphabets import Alphabets
from sgicodec.bitstream.entropy.tables import MAX_MAGNITUDE, escape_frequencies, frequency_tables
from sgicodec.errors import require

__all__ = [
    "ZERO_CENTRED",
    "CategoricalModels",
    "SymbolModels",
    "constriction",
    "escape_alphabet",
    "uniform_model",
    "zero_centred_tables",
]


@cache
def constriction() -> ModuleType:
    """The library that writes; reading is native. Raises MissingExtraError where it is not installed."""
    require("constriction", "encoding")
    import constriction

    return constriction  # type: ignore[no-any-return]


class SymbolModels(Protocol):
    """Models by key, for either direction."""

    @property
    def reading(self) -> _native.SymbolModels:
        """All of them for the range decoder."""

    def writing(self, key: int) -> Any:
        """One for constriction; None for a single symbol, which needs no coding."""


@dataclass(frozen=True)
class CategoricalModels:
    """Those of alphabets, by context."""

    alphabets: Alphabets

    @property
    def reading(self) -> _native.SymbolModels:
        return self.alphabets.models

    def writing(self, key: int) -> Any:
        return _model(self.alphabets.possible[key])


class _ZeroCentred:
    @cached_property
    def reading(self) -> _native.SymbolModels:
        tables = frequency_tables()
        return _native.SymbolModels(tables.frequency, np.append(tables.start, tables.frequency.size))

    def writing(self, key: int) -> Any:
        return _zero_centred_model(key)


ZERO_CENTRED = _ZeroCentred()


def _categorical(frequencies: NDArray[np.int64]) -> Any:
    """A constriction model with exactly these frequencies, two or more.

    Categorical(perfect=False) gives every symbol 1 and shares out what is left in proportion: given f − 1 it
    has a factor of exactly 1, and all its sums are integers below 2**53.
    """
    return constriction().stream.model.Categorical((frequencies - 1).astype(np.float64), perfect=False)


@lru_cache(maxsize=1 << 10)
def _model(frequencies: tuple[int, ...]) -> Any:
    """A model of these frequencies; None for the single symbol that needs no coding."""
    return None if len(frequencies) < 2 else _categorical(np.array(frequencies))


@cache
def _zero_centred_model(table: int) -> Any:
    return _categorical(frequency_tables().frequencies(table))


@cache
def escape_alphabet() -> Alphabets:
    """The one of exponents behind escapes."""
    return Alphabets(escape_frequencies())


@cache
def uniform_model(n_bits: int) -> Any:
    """Equally likely values of `n_bits` bits, for constriction."""
    return constriction().stream.model.Uniform(1 << n_bits)


@cache
def zero_centred_tables() -> _native.ZeroCentredTables:
    """All that reads zero-centred symbols, escapes included."""
    tables = frequency_tables()
    known = tables.support, tables.start, tables.symbol_bits
    return _native.ZeroCentredTables(ZERO_CENTRED.reading, *known, escape_alphabet().models, MAX_MAGNITUDE)
