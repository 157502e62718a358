"""The weights of MLP_p and of the hash grid while they train: floats that become the integers of `model.network`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.fit.weight_bits import ADDED_UNITS, price_slope
from sgicodec.model.context import input_count, output_count
from sgicodec.model.network import DIFFERENCE_SHIFT, IntNetwork
from sgicodec.model.spec import ModelSpec

__all__ = ["ContextWeights", "layer_shapes", "shaped"]

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]

WEIGHT_SHIFT = 6
"""MLP_p's own weights are multiples of 2^-6 (docs/notes/2026-11-paper-profile.md)."""

HASH_START = 1e-4
"""θ of the hash grid starts within ± this: near enough to 0 that a sign can turn while the rate counts
(docs/notes/2026-11-paper-profile.md)."""


def layer_shapes(spec: ModelSpec) -> list[tuple[tuple[int, ...], ...]]:
    """Shapes of W1, b1, W2 and b2 of the network of each coding stage."""
    shapes: list[tuple[tuple[int, ...], ...]] = []
    for number, stage in enumerate(spec.context.steps):
        inputs, hidden = input_count(spec, number), spec.context.hidden
        outputs = sum(2 * output_count(spec, group) for group in stage) + len(stage)
        shapes.append(((hidden, inputs), (hidden,), (outputs, hidden), (outputs,)))
    return shapes


def shaped(shapes: Sequence[tuple[int, ...]], flat: Any) -> list[Any]:
    """Parts of a flat array or tensor in these shapes, one after the other, as views."""
    ends = np.cumsum([math.prod(shape) for shape in shapes]).tolist()
    return [flat[end - math.prod(shape) : end].reshape(shape) for shape, end in zip(shapes, ends, strict=True)]


class ContextWeights:
    """One two-layer network per coding stage, and the hash grid's tables.

    first: W1 of every stage, flat. rest: b1, W2 and b2 of every stage, flat. tables: θ of every resolution, flat.
    difference: what is added to `rest`, where `networks`, integers that stay as they are, were given; else None.
    `trains` says whether `first`, `rest` and `tables` train.
    """

    def __init__(self, spec: ModelSpec, hash_sizes: tuple[int, ...], rng: np.random.Generator) -> None:
        self.spec, self.trains = spec, True
        self.networks: tuple[IntNetwork, ...] | None = None
        self.difference: F32 | None = None
        first, rest = [], []
        for w1, b1, w2, b2 in layer_shapes(spec):
            first.append(rng.standard_normal(math.prod(w1), np.float32) * np.float32((2.0 / w1[1]) ** 0.5))
            second = rng.standard_normal(math.prod(w2), np.float32) * np.float32(0.1 / w2[1] ** 0.5)
            rest += [np.zeros(b1, np.float32), second, np.zeros(b2, np.float32)]
        self.first: F32 = np.concatenate(first)
        self.rest: F32 = np.concatenate(rest)
        self._tables = [(entries, spec.context.hash_features) for entries in hash_sizes]
        count = sum(hash_sizes) * spec.context.hash_features
        self.tables: F32 = (rng.random(count, np.float32) * 2 - 1) * np.float32(HASH_START)
        counts = [math.prod(shape) for shapes in layer_shapes(spec) for shape in shapes[1:]]
        self._counts, self._tensor = np.array(counts, np.float32), np.repeat(np.arange(len(counts)), counts)

    def trained(self) -> dict[str, F32]:
        """What trains, by name."""
        if self.difference is not None:
            return {"context.difference": self.difference}
        if not self.trains:
            return {}
        tables = {"context.tables": self.tables} if self._tables else {}
        return {"context.first": self.first, "context.rest": self.rest, **tables}

    def adapt(self, networks: tuple[IntNetwork, ...]) -> None:
        """Takes the weights of `networks`, of which all but W1 may differ from now on."""
        self.load(networks)
        self.networks, self.difference = networks, np.zeros_like(self.rest)

    def centre(self, attributes: F32) -> None:
        """Makes the biases of the means and scales those of attributes [N, d_A], in base steps, at one coding stage."""
        *_, biases = shaped([shape for shapes in layer_shapes(self.spec) for shape in shapes[1:]], self.rest)
        deviation = attributes.std(axis=0)
        biases[: 2 * len(deviation)] = np.concatenate([attributes.mean(axis=0), np.log2(np.maximum(deviation, 0.25))])

    def say_constants(self, attributes: F32) -> None:
        """Makes the networks and the hash grid say the same of all seeds, as `centre` does, at next to no bits."""
        self.first[:] = 0
        self.rest[:] = 0
        self.tables[:] = 1
        self.centre(attributes)

    def freeze(self) -> None:
        """Takes the weights that the stream would hold now; nothing trains from now on."""
        self.networks = self.integers()
        self.load(self.networks)

    def load(self, networks: tuple[IntNetwork, ...]) -> None:
        """Sets the weights to what integer networks hold; they train no more, and differences end."""
        self.difference, self.trains = None, False
        scaled = [[array * 2.0**-n.shift for array in (n.w1, n.b1, n.w2, n.b2)] for n in networks]
        self.first = np.concatenate([one[0].reshape(-1) for one in scaled]).astype(np.float32)
        self.rest = np.concatenate([part.reshape(-1) for one in scaled for part in one[1:]]).astype(np.float32)

    def effective_rest(self) -> F32:
        """b1, W2 and b2 of every stage with their differences, flat."""
        return self.rest if self.difference is None else self.rest + self.difference

    def integers(self, shift: int = WEIGHT_SHIFT) -> tuple[IntNetwork, ...]:
        """The networks as the stream would hold them now; own ones in multiples of 2^-shift."""
        if self.networks is None:
            return self._own(shift)
        if self.difference is None:
            return self.networks
        parts = self._rest_layers(_rounded(self.difference, DIFFERENCE_SHIFT))
        return tuple(network.plus(*part) for network, part in zip(self.networks, parts, strict=True))

    def signs(self) -> list[I64]:
        """The grid's bits as 0 or 1, [entries, F] per resolution."""
        return self.per_table((self.tables >= 0).astype(np.int64))

    def per_table(self, flat: Any) -> list[Any]:
        """The parts [entries, F] of a flat array or tensor that each resolution has."""
        return shaped(self._tables, flat)

    def difference_gradient(self, lmbda: float) -> F32:
        """Gradient of λ times what the differences cost: each tensor under the Laplacian of its own mean magnitude."""
        if self.difference is None:
            raise ValueError("the weights have no differences")
        sums = np.zeros_like(self._counts)
        np.add.at(sums, self._tensor, np.abs(self.difference) * np.float32(2.0**DIFFERENCE_SHIFT))
        mean = (sums / self._counts + np.float32(ADDED_UNITS)) * np.float32(math.log(2.0))
        slope = (np.float32(lmbda) / mean)[self._tensor]
        gradient: F32 = slope * np.sign(self.difference) * np.float32(2.0**DIFFERENCE_SHIFT)
        return gradient

    def gradients(self, sums: F32, tables: F32, lmbda: float) -> dict[str, F32]:
        """By name, at one coding stage: from those of b1, W2, b2 and W1 that seeds have, and from those of all tables,
        both flat; with λ times what W1 and W2 cost, each under the Laplacian of its own mean magnitude.
        """
        [(_, b1, w2, _)] = layer_shapes(self.spec)
        rest, first = sums[: len(self.rest)], sums[len(self.rest) :]
        second = slice(math.prod(b1), math.prod(b1) + math.prod(w2))
        first += price_slope(self.first, WEIGHT_SHIFT, lmbda)
        rest[second] += price_slope(self.rest[second], WEIGHT_SHIFT, lmbda)
        return {"context.first": first, "context.rest": rest, "context.tables": tables}

    def _own(self, shift: int) -> tuple[IntNetwork, ...]:
        firsts = shaped([shapes[0] for shapes in layer_shapes(self.spec)], _rounded(self.first, shift))
        rests = self._rest_layers(_rounded(self.effective_rest(), shift))
        counts = [sum(output_count(self.spec, group) for group in stage) for stage in self.spec.context.steps]
        return tuple(
            IntNetwork(w1, b1, w2, b2, shift, count)
            for w1, (b1, w2, b2), count in zip(firsts, rests, counts, strict=True)
        )

    def _rest_layers(self, flat: I64) -> list[list[I64]]:
        """b1, W2 and b2 of every stage."""
        parts = shaped([shape for shapes in layer_shapes(self.spec) for shape in shapes[1:]], flat)
        return [parts[at : at + 3] for at in range(0, len(parts), 3)]


def _rounded(values: F32, shift: int) -> I64:
    """In units of 2^-shift."""
    return np.rint(values.astype(np.float64) * 2.0**shift).astype(np.int64)
