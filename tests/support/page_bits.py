"""Bits under adaptive models, as docs/format.md says ("Bits")."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from typing import Any

import constriction
import numpy as np

STEADY, QUICK = 511, 80

Code = Callable[[int], int]
"""Gives the next bit, of P(1) in 2^-16."""


def coded_bits(data: bytes) -> Code:
    """What reads bits from the bytes of a range coder, whose probabilities have 24 bits."""
    return opened_bits(data)[1]


def opened_bits(data: bytes) -> tuple[Any, Code]:
    """The decoder of such bytes, which knows whether they are at an end, and what reads from it."""
    words = np.frombuffer(data + bytes(-len(data) % 4), ">u4").astype(np.uint32)
    decoder, model = constriction.stream.queue.RangeDecoder(words), constriction.stream.model.Bernoulli(perfect=False)
    return decoder, lambda one: int(decoder.decode(model, np.array([1 - (0x1000000 - 256 * one - 0.5) / 0xFFFFFE]))[0])


class BitModels:
    """Models by what tells them apart: parts of logits, and how many bits each has seen."""

    def __init__(self) -> None:
        self.models: dict[Hashable, tuple[int, int]] = {}

    def p(self, *models: Hashable) -> int:
        """P(1) by these models."""
        logit = sum((b << 10) + s for b, s in (self.models.get(model, (0, 0)) for model in models)) >> 18
        return min(65519, max(16, round(65536 / (1 + math.exp(-min(3071, max(-3072, logit)) / 256)))))

    def learn(self, bit: int, limit: int, *models: Hashable) -> None:
        """Moves them towards a bit."""
        error = 65536 * bit - self.p(*models)
        for model in models if abs(error) >= 18 else ():
            b, s = self.models.get(model, (0, 0))
            self.models[model] = b + ((error * (393216 // (16 + s)) + 32768) >> 16), min(limit, s + 1)

    def bit(self, code: Code, limit: int, *models: Hashable) -> int:
        """A bit under these models, which learn it; even without any."""
        bit = code(self.p(*models))
        self.learn(bit, limit, *models)
        return bit
