"""Roots of integers, exactly."""

from __future__ import annotations


def root(value: int, degree: int) -> int:
    """Floor of the degree-th root."""
    low, high = 0, 1 << (value.bit_length() // degree + 1)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if middle**degree <= value else (low, middle)
    return low
