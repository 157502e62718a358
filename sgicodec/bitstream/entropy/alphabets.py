"""Small alphabets with stated frequencies: what categorical symbols are coded under."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.tables import TOTAL, bits_of_frequencies
from sgicodec.errors import UsageError

__all__ = ["Alphabets"]


@dataclass(frozen=True, eq=False)
class Alphabets:
    """Frequencies of symbols 0 … A−1 in each of several contexts [contexts, A].

    Rows sum to 2**24; a symbol of frequency 0 cannot occur, and one of frequency 2**24 costs nothing. Raises UsageError
    for a bad row.
    """

    frequencies: NDArray[np.int64]

    def __post_init__(self) -> None:
        if np.any(self.frequencies < 0) or np.any(self.frequencies.sum(axis=1) != TOTAL):
            raise UsageError(f"entropy: frequencies must be non-negative and sum to {TOTAL} in every row")

    @cached_property
    def rank(self) -> NDArray[np.int32]:
        """Index of each symbol among those that can occur [contexts, A]."""
        return np.cumsum(self.frequencies > 0, axis=1, dtype=np.int32) - np.int32(1)

    @cached_property
    def possible(self) -> list[tuple[int, ...]]:
        """Frequencies of the symbols that can occur, by context."""
        return [tuple(row[row > 0].tolist()) for row in self.frequencies]

    @cached_property
    def bits(self) -> NDArray[np.float64]:
        """Information content of every symbol [contexts, A]; 0 for what cannot occur."""
        return np.where(self.frequencies > 0, bits_of_frequencies(np.maximum(self.frequencies, 1)), 0.0)
