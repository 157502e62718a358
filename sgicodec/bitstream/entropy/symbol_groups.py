"""Symbols and the numbers of their models in the forms and the order in which they are coded."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgicodec.errors import UsageError

__all__ = ["IntArray", "as_keys", "as_values", "groups"]

IntArray = NDArray[np.int32]


def as_values(symbols: ArrayLike, count: int) -> NDArray[np.int64]:
    """Symbols [n] as 64-bit integers. Raises UsageError where there are not `count`."""
    values = np.asarray(symbols, np.int64).reshape(-1)
    if values.size != count:
        raise UsageError(f"entropy: {values.size} symbols for {count} models")
    return values


def as_keys(models: ArrayLike, count: int) -> NDArray[np.int16]:
    """Model numbers [n] as 16-bit integers. Raises UsageError for one outside 0 … count − 1."""
    keys = np.asarray(models).reshape(-1)
    if keys.size and not 0 <= int(keys.min()) <= int(keys.max()) < min(count, 1 << 15):
        raise UsageError(f"entropy: a table index or context is outside 0..{count - 1}")
    return keys.astype(np.int16)


def groups(keys: NDArray[np.int16], count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Positions [n] ordered by key, equal keys by position, and where those of each key 0 … count begin [count + 1]."""
    start = np.concatenate([[0], np.cumsum(np.bincount(keys, minlength=count))])
    return np.argsort(keys, kind="stable"), start
