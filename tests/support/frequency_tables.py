"""The zero-centred frequency tables of docs/format.md, from the file that ships, and as constriction has them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import constriction
import numpy as np
from numpy.typing import NDArray

SCALES, TABLES, TOTAL, MAX_MAGNITUDE = 64, 128, 1 << 24, 1 << 20
FILE = files("sgicodec.bitstream.parts").joinpath("tables.bin")


@dataclass(frozen=True)
class FrequencyTables:
    """support [TABLES]: S of each; of_table: its frequencies [2S + 2], those of −S … S and of the escape."""

    support: NDArray[np.int64]
    of_table: list[NDArray[np.int64]]

    def bits(self, symbols: NDArray[np.int64], table: int) -> NDArray[np.float64]:
        """Information content of symbols within the support of a table."""
        return 24 - np.log2(self.of_table[table][symbols + self.support[table]])


@cache
def frequency_tables() -> FrequencyTables:
    """All S as u16, then per table f(0) … f(S), f(escape) as u32."""
    data = FILE.read_bytes()
    support = np.frombuffer(data, "<u2", TABLES).astype(np.int64)
    halves = np.split(np.frombuffer(data, "<u4", offset=2 * TABLES).astype(np.int64), np.cumsum(support + 2)[:-1])
    return FrequencyTables(support, [np.concatenate([half[-2:0:-1], half]) for half in halves])


def _categorical(frequencies: NDArray[np.int64]) -> Any:
    """With f − 1 constriction has a factor of exactly 1, and all its sums are integers below 2**53."""
    return constriction.stream.model.Categorical((frequencies - 1).astype(np.float64), perfect=False)


@cache
def zero_centred_model(table: int) -> Any:
    """constriction's model of a table."""
    return _categorical(frequency_tables().of_table[table])


@cache
def escape_model() -> Any:
    """That of the exponents behind escapes."""
    return _categorical(TOTAL >> np.minimum(np.arange(1, 22), 20))


@cache
def uniform_model(n_bits: int) -> Any:
    """Equally likely values."""
    return constriction.stream.model.Uniform(1 << n_bits)
