"""Every number that steers RDOQ."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["RdoqSettings"]


@dataclass(frozen=True)
class RdoqSettings:
    """How RDOQ follows a fit.

    passes: times that all seeds are gone through; the best outcome counts. deep: choices of a seed's colours that are
    followed to its shape and offset. rounds: times that the symbols of a shape or an offset are gone through. coarser:
    octaves by which steps grow beforehand, since symbols that are searched want coarser steps than the noise that they
    were trained with. base: whether the base layer moves too. drop: a seed goes when that costs less squared error than
    this many times its price. position_bits: what a seed's place adds to its price.
    """

    passes: int = 6
    deep: int = 3
    rounds: int = 3
    coarser: float = 0.3
    base: bool = True
    drop: float = 1.2
    position_bits: float = 3.0
