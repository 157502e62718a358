"""What the noise of a step is a hash of."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["NoiseKey"]


class NoiseKey(NamedTuple):
    """What noise is a hash of, in 32 bits; `negative` for that noise with its signs turned."""

    key: int
    negative: bool

    @classmethod
    def of(cls, seed: int, number: int) -> NoiseKey:
        """That of step `number`: steps go in pairs of opposite noise, whose errors of first order cancel."""
        pair, second = divmod(number, 2)
        return cls((seed * 0x9E3779B1 + pair * 0x85EBCA77) & 0xFFFFFFFF, bool(second))
