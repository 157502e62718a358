"""Probability models of symbols for constriction, which writes."""

from __future__ import annotations

from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.tables import escape_frequencies, frequency_tables
from sgicodec.errors import require

__all__ = ["constriction", "escape_model", "uniform_model", "zero_centred_model"]


@cache
def constriction() -> ModuleType:
    """The library that writes; reading is native. Raises MissingExtraError where it is not installed."""
    require("constriction", "encoding")
    import constriction

    return constriction  # type: ignore[no-any-return]


def _categorical(frequencies: NDArray[np.int64]) -> Any:
    """A constriction model with exactly these frequencies, two or more.

    Categorical(perfect=False) gives every symbol 1 and shares out what is left in proportion: given f − 1 it
    has a factor of exactly 1, and all its sums are integers below 2**53.
    """
    return constriction().stream.model.Categorical((frequencies - 1).astype(np.float64), perfect=False)


@cache
def zero_centred_model(table: int) -> Any:
    """That of a zero-centred table."""
    return _categorical(frequency_tables().frequencies(table))


@cache
def escape_model() -> Any:
    """That of exponents behind escapes."""
    return _categorical(escape_frequencies())


@cache
def uniform_model(n_bits: int) -> Any:
    """Equally likely values of `n_bits` bits."""
    return constriction().stream.model.Uniform(1 << n_bits)
