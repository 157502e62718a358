"""The weights of MLP_p and of the hash grid in floats: those that train, and the shipped ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from sgicodec.arrays import F32, I64
from sgicodec.fit.weight_bits import price_slope
from sgicodec.model.context import network_shapes, output_count
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec

WEIGHT_SHIFT = 6
"""Weights of an MLP_p that trains are multiples of 2^-6 (docs/notes/2026-11-paper-profile.md)."""

FINER = 0.3125
"""Octaves by which the steps of a fit are finer than those of its stream: symbols that RDOQ finds want coarser ones
than the noise that they were trained with (docs/notes/2026-11-rdoq.md)."""

_HASH_START = 1e-4
"""θ of the hash grid starts within ± this: near enough to 0 that a sign can turn while the rate counts
(docs/notes/2026-11-paper-profile.md)."""


def shaped(shapes: Sequence[tuple[int, ...]], flat: Any) -> list[Any]:
    """Parts of a flat array or tensor in these shapes, one after the other, as views."""
    ends = np.cumsum([math.prod(shape) for shape in shapes]).tolist()
    return [flat[end - math.prod(shape) : end].reshape(shape) for shape, end in zip(shapes, ends, strict=True)]


def float_weights(networks: Sequence[IntNetwork], finer: float = FINER) -> tuple[F32, F32]:
    """W1 of every stage, and b1, W2 and b2 of every stage, flat. finer: by how many octaves steps are."""
    first, rest = [], []
    for network in networks:
        w1, b1, w2, b2 = (array * 2.0**-network.shift for array in network.arrays)
        b2[2 * network.predicted :] -= finer
        first.append(w1)
        rest += [b1, w2, b2]
    flat = [np.concatenate([part.reshape(-1) for part in parts]).astype(np.float32) for parts in (first, rest)]
    return flat[0], flat[1]


class ContextWeights:
    """MLP_p of one coding stage and the hash grid's tables, which all train.

    first: W1, flat. rest: b1, W2 and b2, flat. tables: θ of every resolution, flat.
    """

    def __init__(self, spec: ModelSpec, hash_counts: Sequence[int], rng: np.random.Generator) -> None:
        self.spec = spec
        w1, b1, w2, b2 = self._shapes = tuple(network_shapes(spec, 0).values())
        self.first: F32 = rng.standard_normal(math.prod(w1), np.float32) * np.float32((2.0 / w1[1]) ** 0.5)
        second = rng.standard_normal(math.prod(w2), np.float32) * np.float32(0.1 / w2[1] ** 0.5)
        self.rest: F32 = np.concatenate([np.zeros(b1, np.float32), second, np.zeros(b2, np.float32)])
        self._tables = [(count // spec.context.hash_features, spec.context.hash_features) for count in hash_counts]
        self.tables: F32 = (rng.random(sum(hash_counts), np.float32) * 2 - 1) * np.float32(_HASH_START)

    def trained(self) -> dict[str, F32]:
        """What trains, by name."""
        return {"context.first": self.first, "context.rest": self.rest, "context.tables": self.tables}

    def centre(self, attributes: F32) -> None:
        """Makes the biases of the means and scales those of attributes [N, d_A], in base steps."""
        *_, biases = shaped(self._shapes[1:], self.rest)
        deviation = attributes.std(axis=0)
        biases[: 2 * len(deviation)] = np.concatenate([attributes.mean(axis=0), np.log2(np.maximum(deviation, 0.25))])

    def say_constants(self, attributes: F32) -> None:
        """Makes the network and the hash grid say the same of all seeds, as `centre` does, at next to no bits."""
        self.first[:] = 0
        self.rest[:] = 0
        self.tables[:] = 1
        self.centre(attributes)

    def integers(self) -> IntNetwork:
        """The network as the stream would hold it now, in multiples of 2^-WEIGHT_SHIFT."""
        [w1], (b1, w2, b2) = (
            shaped(shapes, np.rint(values.astype(np.float64) * 2.0**WEIGHT_SHIFT).astype(np.int64))
            for shapes, values in ((self._shapes[:1], self.first), (self._shapes[1:], self.rest))
        )
        predicted = sum(output_count(self.spec, group) for group in self.spec.context.steps[0])
        return IntNetwork(w1, b1, w2, b2, WEIGHT_SHIFT, predicted)

    def signs(self) -> list[I64]:
        """The grid's bits as 0 or 1, [entries, F] per resolution."""
        return self.per_table((self.tables >= 0).astype(np.int64))

    def per_table(self, flat: Any) -> list[Any]:
        """The parts [entries, F] of a flat array or tensor that each resolution has."""
        return shaped(self._tables, flat)

    def gradients(self, sums: F32, tables: F32, lmbda: float) -> dict[str, F32]:
        """By name: from those of b1, W2, b2 and W1 that seeds have, and from those of all tables, both flat; with λ
        times what W1 and W2 cost, each under the Laplacian of its own mean magnitude.
        """
        _, b1, w2, _ = self._shapes
        rest, first = sums[: len(self.rest)], sums[len(self.rest) :]
        second = slice(math.prod(b1), math.prod(b1) + math.prod(w2))
        first += price_slope(self.first, WEIGHT_SHIFT, lmbda)
        rest[second] += price_slope(self.rest[second], WEIGHT_SHIFT, lmbda)
        return {"context.first": first, "context.rest": rest, "context.tables": tables}
