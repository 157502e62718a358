"""Pictures coded by a peer into a given number of bytes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

__all__ = ["TOLERANCE", "best_within"]

TOLERANCE = 1.02
"""How many times the bytes asked for a peer may take, since its qualities come in steps."""


def best_within(qualities: Sequence[float], size_of: Callable[[float], int], limit: float) -> float | None:
    """The last of the qualities, which stand by rising size, that stays within the limit; None if the first does not.

    By bisection: sizes that fall back in places may hide a later one.
    """
    low, high = -1, len(qualities)  # the first is within, the second is not
    while high - low > 1:
        middle = (low + high) // 2
        if size_of(qualities[middle]) <= limit:
            low = middle
        else:
            high = middle
    return qualities[low] if low >= 0 else None
