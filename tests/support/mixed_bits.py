"""Bits under adaptive models of which four are mixed, as docs/format.md says ("Bits elsewhere")."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

__all__ = ["LOGIT", "Code", "MixedModels", "adapted"]

LOGIT = [round(256 * math.log((2 * i + 1) / (8191 - 2 * i))) for i in range(4096)]

Code = Callable[[int], int]
"""Gives the next bit, of P(1) in 2^-16."""


class MixedModels:
    """Models by number, and sets of weights."""

    def __init__(self) -> None:
        self.models: dict[int | tuple[int, ...], tuple[int, int]] = {}
        self.weights: dict[int, list[int]] = {}

    def bit(self, code: Code, numbers: Sequence[int], set_: int) -> int:
        """A bit that four models predict."""
        logits = [LOGIT[self.models.get(number, (32768, 0))[0] >> 4] for number in numbers]
        weights = self.weights.setdefault(set_, [16384] * 4)
        total = sum(weight * logit for weight, logit in zip(weights, logits, strict=True)) >> 16
        one = _logistic(min(3071, max(-3072, total)))
        bit = code(one)
        for i, logit in enumerate(logits):
            weights[i] = min(1 << 20, max(-(1 << 20), weights[i] + ((logit * (65536 * bit - one)) >> 15)))
        for number in numbers:
            self.models[number] = adapted(*self.models.get(number, (32768, 0)), bit)
        return bit

    def alone(self, code: Code, context: tuple[int, ...]) -> int:
        """A bit that one model predicts, or none."""
        if not context:
            return code(32768)
        p, seen = self.models.get(context, (32768, 0))
        bit = code(min(65520, max(16, p)))
        self.models[context] = adapted(p, seen, bit)
        return bit


def adapted(p: int, seen: int, bit: int) -> tuple[int, int]:
    """A model after a bit."""
    return p + (((65535 * bit - p) * (655360 // (10 * seen + 16))) >> 16), min(seen + 1, 150)


def _logistic(x: int) -> int:
    return min(65519, max(16, round(65536 / (1 + math.exp(-x / 256)))))
