"""The seeds of a fit and what they hold, while some are dropped and others added."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32
from sgicodec.device import Device
from sgicodec.fit.adam import Adam
from sgicodec.fit.initialization import CellMeans, fresh_decoders, fresh_values
from sgicodec.fit.weight_bits import decoder_shift
from sgicodec.model.gaussians import decoder_parts, model_gaussians
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec


def coded_values(values: Mapping[str, Any], xp: Any) -> dict[str, Any]:
    """Attributes by group as they are coded, of those that train, in numpy or torch: the logarithms of s_o and s_a
    train, they themselves are coded.
    """
    return {name: xp.exp(value) if name == "scales" else value for name, value in values.items()}


class SeedSet:
    """Starts from what `target` [C, H, W] is in the cells of `layout`.

    layout: where the seeds are now; values: what trains of their attributes by group [N, size]; decoder_weights:
    of MLP_c and MLP_Σ, flat; decoders: the same by name. A stream holds them in units of 2^-decoder_shift.
    """

    def __init__(
        self, spec: ModelSpec, layout: SeedLayout, target: F32, rng: np.random.Generator, device: Device
    ) -> None:
        self.spec, self.layout, self._device = spec, layout, device
        self._pixels = target.shape[1] * target.shape[2]
        self.values = self._fresh(CellMeans(target).of(layout))
        self.decoder_weights: F32 = np.concatenate(
            [np.zeros(0, np.float32), *(weights.reshape(-1) for weights in fresh_decoders(spec, rng).values())]
        )
        self.decoders = decoder_parts(spec, self.decoder_weights)
        colours = sum(weights.size for name, weights in self.decoders.items() if name.startswith("colour"))
        self._networks = {"colour": slice(0, colours), "shape": slice(colours, None)} if colours else {}
        self.decoder_shift = decoder_shift(len(layout))

    def __len__(self) -> int:
        return len(self.layout)

    def by_network(self, flat: F32) -> dict[str, F32]:
        """The parts of MLP_c, "colour", and MLP_Σ, "shape", of an array that begins like `decoder_weights`."""
        own = flat[: len(self.decoder_weights)]
        return {name: own[part] for name, part in self._networks.items()}

    def attributes(self) -> F32:
        """The attributes of all groups as they are coded, side by side [N, d_A]."""
        coded = self.coded()
        return np.concatenate([coded[group.name] for group in self.spec.groups], axis=1)

    def coded(self) -> dict[str, F32]:
        """The attributes as they are coded, by group [N, size]."""
        return coded_values(self.values, np)

    def gaussians(self) -> tuple[F32, F32, F32]:
        """Means [N·K, 2], covariances [N·K, 3] and colours [N·K, C] of the exact values."""
        return model_gaussians(self.spec, self.attributes(), self.layout, self.decoders, self._device)

    def energy(self) -> F32:
        """Squared samples that the Gaussians of each seed would draw alone, over the plane [N]."""
        _, covariances, colours = self.gaussians()
        determinant = covariances[:, 0] * covariances[:, 2] - covariances[:, 1] ** 2
        spread = np.sqrt(np.maximum(determinant, np.float32(1e-9)))
        energy = math.pi * spread * (colours**2).sum(axis=1)  # of c·G
        total: F32 = energy.reshape(len(self), -1).sum(axis=1)
        return total

    def keep(self, kept: NDArray[np.bool_], adam: Adam) -> None:
        """Drops all seeds but those where `kept` [N] holds, and what `adam` knows of them."""
        for name, value in self.values.items():
            self.values[name] = value[kept]
            adam.keep(name, kept)
        self.layout = self.layout.take(kept)

    def add(self, layout: SeedLayout, means: F32, adam: Adam) -> None:
        """Appends fresh seeds [n] in whose cells the picture has these means [n, C], with zero moments in `adam`."""
        for name, fresh in self._fresh(means).items():
            self.values[name] = np.concatenate([self.values[name], fresh])
            adam.add(name, len(fresh))
        corner = np.concatenate([self.layout.corner, layout.corner])
        self.layout = SeedLayout(corner, np.concatenate([self.layout.log_size, layout.log_size]))

    def _fresh(self, means: F32) -> dict[str, F32]:
        return fresh_values(self.spec, means, self._pixels)
