"""The seeds of a fit and what they hold, while some are dropped and others added."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec.fit.adam import Adam
from sgicodec.fit.initialization import cell_means, fresh_decoders, fresh_values
from sgicodec.model.gaussians import colour_matrix, gaussians_from_seeds
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec

__all__ = ["Population"]

F32 = NDArray[np.float32]


class Population:
    """Starts from what `target` [C, H, W] is in the cells of `layout`.

    layout: where the seeds are now; values: their attributes by group [N, size]; decoders: weights of MLP_c and MLP_Σ.
    Values and decoders are the leaves that train.
    """

    def __init__(self, spec: ModelSpec, layout: SeedLayout, target: F32, generator: torch.Generator) -> None:
        self.spec, self.layout = spec, layout
        self._generator, self._pixels = generator, target.shape[1] * target.shape[2]
        self._opponent = torch.tensor(colour_matrix(spec.channels))
        fresh = self._fresh(cell_means(target, layout))
        self.values = {name: value.requires_grad_() for name, value in fresh.items()}
        self.decoders = fresh_decoders(spec, generator)
        self._place(layout)

    def __len__(self) -> int:
        return len(self.layout)

    def attributes(self) -> Tensor:
        """The values of all groups side by side [N, d_A]."""
        return torch.cat([self.values[group.name] for group in self.spec.groups], dim=1)

    def gaussians(self, attributes: Tensor, level: int = 0) -> tuple[Tensor, Tensor, Tensor]:
        """Means [N·K, 2], covariances [N·K, 3] and colours [N·K, C] of these attributes [N, d_A], at a level of the
        pyramid.
        """
        scale = 0.5**level
        means, covariances, colours = gaussians_from_seeds(
            self.spec, attributes, self._centre * scale, self._cell * scale, self.decoders, self._opponent, torch
        )
        return means, covariances, colours

    @torch.no_grad()
    def energy(self) -> Tensor:
        """Squared samples that the Gaussians of each seed would draw alone, over the plane [N]."""
        _, covariances, colours = self.gaussians(self.attributes())
        spread = (covariances[:, 0] * covariances[:, 2] - covariances[:, 1] ** 2).clamp_min(1e-9).sqrt()
        energy = math.pi * spread * (colours**2).sum(1)  # of c·G
        return energy.reshape(len(self), -1).sum(1)

    def keep(self, kept: Tensor, optimizer: Adam) -> None:
        """Drops all seeds but those where `kept` [N] holds, and what `optimizer` knows of them."""
        self._change_rows(lambda _, tensor: tensor[kept], optimizer)
        self._place(self.layout.take(kept.numpy()))

    def add(self, layout: SeedLayout, means: F32, optimizer: Adam) -> None:
        """Appends fresh seeds [n] in whose cells the picture has these means [n, C]; `optimizer` has seen nothing of
        them.
        """
        fresh = self._fresh(means)
        self._change_rows(lambda name, tensor: torch.cat([tensor, torch.zeros_like(fresh[name])]), optimizer)
        with torch.no_grad():
            for name, value in fresh.items():
                self.values[name][-len(value) :] = value
        corner = np.concatenate([self.layout.corner, layout.corner])
        self._place(SeedLayout(corner, np.concatenate([self.layout.log_size, layout.log_size])))

    def _fresh(self, means: F32) -> dict[str, Tensor]:
        return fresh_values(self.spec, torch.from_numpy(means), self._opponent, self._pixels, self._generator)

    def _change_rows(self, change: Callable[[str, Tensor], Tensor], optimizer: Adam) -> None:
        """Replaces each group of values, and Adam's moments of it, by `change(group's name, tensor)`."""
        for name in self.values:
            self.values[name] = optimizer.replace(name, partial(change, name))

    def _place(self, layout: SeedLayout) -> None:
        self.layout = layout
        self._centre, self._cell = torch.from_numpy(layout.centre), torch.from_numpy(layout.cell)
