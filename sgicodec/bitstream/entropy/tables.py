"""Integer frequency tables of the range coder, always the same on every machine.

A table gives every symbol an integer frequency of at least 1; the frequencies of a table sum to 2**PRECISION.

- Zero-centred tables code n = round((v − m) / q), the distance of a value from its predicted mean in steps.
  Table index = family · SCALES + i stands for standard deviation σ_i = 2**((i − 24) / 6) steps: 1/16 to 90
  steps in ratios of 12 %. They were computed once by `make_tables.py` and ship with the extension: two versions of a
  mathematics library that differ in the last bit can therefore never disagree about a stream.
- Bernoulli tables code one bit with a probability given in eight bits.

Floating point appears only in `bits`, which measures and never codes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgicodec._native import shipped

__all__ = [
    "ESCAPE_EXPONENTS",
    "FAMILIES",
    "MAX_MAGNITUDE",
    "PRECISION",
    "SCALES",
    "TABLES",
    "TOTAL",
    "FrequencyTables",
    "bits_of_frequencies",
    "escape_bits",
    "escape_exponent",
    "escape_frequencies",
    "frequency_tables",
]

PRECISION = 24
TOTAL = 1 << PRECISION
"""Sum of every table's frequencies."""

SCALES = 64
FAMILIES = ("gaussian", "laplace")
TABLES = SCALES * len(FAMILIES)

MAX_MAGNITUDE = 1 << 20
"""Largest |n| that a stream may hold: no sane step needs it, and sums of symbols stay far from overflow."""

ESCAPE_EXPONENTS = 21
"""Number of Exp-Golomb exponents behind an escape: |n| − S − 1 lies in 0 .. MAX_MAGNITUDE − 1."""


@dataclass(frozen=True)
class FrequencyTables:
    """All zero-centred tables. Table t codes −support[t] … support[t] themselves, others behind an escape."""

    support: NDArray[np.int32]  # [TABLES] S
    start: NDArray[np.int64]  # [TABLES] where a table starts in `frequency`
    frequency: NDArray[np.int64]  # [Σ 2S+2] for n = −S … S, then the escape
    symbol_bits: NDArray[np.float64]  # [Σ 2S+2] −log2 of the probability

    def frequencies(self, table: int) -> NDArray[np.int64]:
        """[2S+2] frequencies of one table: n = −S … S, then the escape."""
        begin = int(self.start[table])
        return self.frequency[begin : begin + 2 * int(self.support[table]) + 2]

    def bits(self, symbols: ArrayLike, tables: ArrayLike) -> NDArray[np.float64]:
        """Exact information content in bits of each symbol under its table, escapes included.

        `symbols` and `tables` are integers that broadcast against each other.
        """
        n = np.asarray(symbols, np.int64)
        t = np.asarray(tables)
        support = self.support[t]
        excess = np.abs(n) - support
        index = self.start[t] + np.where(excess > 0, 2 * support + 1, n + support)
        cost: NDArray[np.float64] = self.symbol_bits[index]
        if np.any(excess > 0):
            cost = cost + np.where(excess > 0, escape_bits(np.maximum(excess - 1, 0)), 0.0)
        return cost

    def best(self, symbols: ArrayLike) -> int:
        """Index of the table under which all `symbols` together cost the fewest bits; 0 for no symbols."""
        values, counts = np.unique(np.asarray(symbols), return_counts=True)
        cost = self.bits(values[None, :], np.arange(TABLES)[:, None]) @ counts  # [TABLES]
        return int(np.argmin(cost))


def escape_exponent(excess: NDArray[np.integer]) -> NDArray[np.int32]:
    """floor(log2(excess + 1)) for excess = |n| − S − 1 ≥ 0."""
    return (np.frexp((excess + 1).astype(np.float64))[1] - 1).astype(np.int32)


def escape_frequencies() -> NDArray[np.int64]:
    """[ESCAPE_EXPONENTS] frequencies 2**−(e+1) of the exponents e, the last one as likely as the last but
    one: the unary prefix of an Exp-Golomb code of order 0.
    """
    return TOTAL >> np.minimum(np.arange(1, ESCAPE_EXPONENTS + 1), ESCAPE_EXPONENTS - 1)


def escape_bits(excess: NDArray[np.integer]) -> NDArray[np.float64]:
    """Bits behind an escape: exponent, as many mantissa bits, sign."""
    exponent = escape_exponent(excess)
    return (np.minimum(exponent + 1, ESCAPE_EXPONENTS - 1) + exponent + 1).astype(np.float64)


def bits_of_frequencies(frequency: ArrayLike) -> NDArray[np.float64]:
    """−log2(frequency / 2**PRECISION); infinite for frequency 0."""
    with np.errstate(divide="ignore"):
        return PRECISION - np.log2(np.asarray(frequency, np.float64))


@cache
def frequency_tables() -> FrequencyTables:
    """The zero-centred tables, from `tables.bin`: all S as u16, then per table f(0) … f(S), f(escape) as u32."""
    data = shipped("tables", 0)
    support = np.frombuffer(data, "<u2", TABLES).astype(np.int32)
    half = np.frombuffer(data, "<u4", offset=2 * TABLES).astype(np.int64)
    half_start = np.concatenate([[0], np.cumsum(support + 2)])
    start = np.concatenate([[0], np.cumsum(2 * support.astype(np.int64) + 2)])
    table = np.repeat(np.arange(TABLES), 2 * support + 2)  # [Σ 2S+2]
    offset = np.arange(int(start[-1])) - start[table] - support[table]  # −S … S, then S + 1 = escape
    frequency = half[half_start[table] + np.abs(offset)]
    return FrequencyTables(support, start[:-1], frequency, bits_of_frequencies(frequency))
