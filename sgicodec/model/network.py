"""MLP_p in integers: the same outputs on every machine, in any summation order (paper, equation 9)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sgicodec._native import HIDDEN_LIMIT, INPUT_LIMIT
from sgicodec.arrays import I64
from sgicodec.errors import CorruptStreamError
from sgicodec.model.context import INPUT_BITS
from sgicodec.model.quantization import PER_OCTAVE

EXACT = float(1 << 53)


@dataclass(frozen=True)
class IntNetwork:
    """Two linear layers with a ReLU between, all integers: y = W2 · clip(⌊(W1 x + 2^6 b1) 2^-s⌋) + 2^6 b2.

    w1 [hidden, inputs], b1 [hidden], w2 [outputs, hidden], b2 [outputs]. Inputs are in units of 2^-6, weights and
    biases in units of 2^-shift. The outputs are U means, U scales and G refinements.
    Raises CorruptStreamError if a sum could leave the integers that float64 holds exactly.
    """

    w1: I64
    b1: I64
    w2: I64
    b2: I64
    shift: int
    predicted: int

    def __post_init__(self) -> None:
        first = np.abs(self.w1).sum(axis=1).max(initial=0) * INPUT_LIMIT + (
            np.abs(self.b1).max(initial=0) << INPUT_BITS
        )
        second = np.abs(self.w2).sum(axis=1).max(initial=0) * HIDDEN_LIMIT + (
            np.abs(self.b2).max(initial=0) << INPUT_BITS
        )
        if max(float(first), float(second) * PER_OCTAVE) >= EXACT or not 2 <= self.shift <= 20:
            raise CorruptStreamError("context model: weights too large to be evaluated exactly")

    @property
    def arrays(self) -> tuple[I64, I64, I64, I64]:
        """W1, b1, W2 and b2 as native code takes them."""
        w1, b1, w2, b2 = (np.ascontiguousarray(array, np.int64) for array in (self.w1, self.b1, self.w2, self.b2))
        return w1, b1, w2, b2
