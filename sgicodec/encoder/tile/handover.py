"""What seeds hand over to texture in the course of a fit: those that show less than their bits would buy there.

The picture's edges ([sharing.py](sharing.py)) say where seeds begin to show it. Once the fit itself knows what they
show, texture is weighed against them in each superblock of the texture layer: over all of its seeds, over fewer and
over none. The cheapest stays, squared error plus λ times bits. Over all and none texture is searched; in between the
estimate of its cost is corrected by what the search found there. The search over all seeds begins a little ahead, over
what they leave then: beside the fit, which goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sgicodec.encoder.tile.sharing import BLEND, MIN_WEIGHT, of_pixels, smoothed
from sgicodec.encoder.tile.texture_costs import TextureCosts
from sgicodec.model.texture import ROOT_LOG
from sgicodec.model.texture_symbols import roots_of

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Trainer

__all__ = ["HANDOVER", "LOOK_AHEAD", "POSITION_BITS", "Handover"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]
Offsets = tuple[F64, F64]

HANDOVER = 0.4
"""Fraction of a fit after which seeds are handed over: those that stay have time to fill in. 0.25 to 0.3 were tried
(docs/notes/2026-11-encode-speed.md), 0.7 too (docs/notes/2026-11-fit-trials.md)."""
LOOK_AHEAD = 0.3
"""Fraction of a fit after which texture is searched over what seeds leave: beside the fit, where there are cores."""
POSITION_BITS = 3.5
"""What the position of a seed adds to its bits."""
SHARES = (0.0, 0.6, 1.0)
"""Of a superblock's seeds, the faintest first: what is tried without them (docs/notes/2026-11-fit-trials.md)."""
_NEAR = 1.0
"""σ in superblocks with which costs are smoothed: seeds reach over the borders of superblocks
(docs/notes/2026-11-fit-trials.md)."""
_TINY = 1e-9
"""Added to costs, so that they have a logarithm."""


def _offsets(texture: TextureCosts, left: F32) -> Offsets:
    """Logarithms of what the search finds over all seeds, which leave `left`, and over none, less those of the
    estimates.
    """
    pairs = ((texture.over(left), left), (texture.without_seeds, texture.target))
    all_, none = (np.log((_TINY + cost) / (_TINY + texture.estimated_over(some))) for cost, some in pairs)
    return all_, none


@dataclass(frozen=True)
class Handover:
    """The choice for one fit, which is to the target of `texture`. ahead: what `offsets_ahead` gave earlier."""

    trainer: Trainer
    texture: TextureCosts
    ahead: Callable[[], Offsets] | None = None

    def run(self) -> None:
        """Drops the seeds that texture shows for less, and makes errors of superblocks without seeds count least."""
        self.trainer.fetch()
        kept, shares = self.chosen()
        if kept.all():
            return
        kept[self.trainer.seeds.energy().argmax()] = True  # a model without seeds has no gradients
        octaves = np.where(shares == 1.0, np.log2(MIN_WEIGHT), 0.0)
        factor = of_pixels(np.exp2(smoothed(octaves, BLEND)), self.texture.target.shape[1:])
        weights = self.trainer.weights
        self.trainer.keep(kept, np.maximum(factor if weights is None else factor * weights, self._least(weights)))

    def chosen(self) -> tuple[Mask, F64]:
        """Which seeds [N] stay, and which of `SHARES` each superblock loses [rows, columns]."""
        ranks = self._ranks()
        costs = [self._cost(ranks >= share, np.full(self.texture.without_seeds.shape, share)) for share in SHARES]
        best = np.argmin([smoothed(cost, _NEAR) for cost in costs], axis=0)
        shares = np.asarray(SHARES)[best]
        together = self._cost(ranks >= shares.reshape(-1)[self._superblock], shares)
        shares[smoothed(together - costs[0], _NEAR) > 0] = 0.0
        return ranks >= shares.reshape(-1)[self._superblock], shares

    @staticmethod
    def _least(weights: F32 | None) -> F32:
        """The least that an error may count: that of `sharing`, where it is not less already."""
        least = np.float32(MIN_WEIGHT)
        return np.asarray(least if weights is None else np.minimum(least, weights), np.float32)

    def _cost(self, kept: Mask, shares: F64) -> F64:
        """Squared error plus λ times bits of each superblock [rows, columns] with these seeds [N] and texture. shares:
        of the seeds that are left out.
        """
        costs = np.log(_TINY + self.texture.estimated_over(self._left(kept)))
        for part, offset in zip((1 - shares, shares), self._offsets, strict=True):
            costs += part * offset
        bits = self.trainer.seed_bits() + POSITION_BITS
        sums = np.bincount(self._superblock[kept], weights=bits[kept], minlength=costs.size)
        return np.asarray(np.exp(costs) + self.texture.lmbda * sums.reshape(costs.shape), np.float64)

    @cached_property
    def _offsets(self) -> Offsets:
        return self.ahead() if self.ahead is not None else _offsets(self.texture, self._left_by_all)

    def offsets_ahead(self) -> Callable[[], Offsets]:
        """What corrects estimates, over what all seeds leave now; a thread of its own begins to search for it."""
        self.trainer.fetch()
        texture, left = self.texture, self._left_by_all
        if texture.device.cores == 1:
            offsets = _offsets(texture, left)
            return lambda: offsets
        from concurrent.futures import ThreadPoolExecutor

        executor = ThreadPoolExecutor(1)
        coming = executor.submit(_offsets, texture, left)
        executor.shutdown(wait=False)
        return coming.result

    def _left(self, kept: Mask) -> F32:
        """What these seeds [N] leave of the target."""
        if kept.all():
            return self._left_by_all
        return self._without(kept) if kept.any() else self.texture.target

    @cached_property
    def _left_by_all(self) -> F32:
        return self._without(np.ones(len(self.trainer.seeds), bool))

    def _without(self, kept: Mask) -> F32:
        target = self.texture.target
        means, covariances, colours = (part[kept] for part in self._gaussians)
        return target - self.trainer.raster.forward(means, covariances, colours, target.shape[2], target.shape[1])

    @cached_property
    def _gaussians(self) -> tuple[F32, F32, F32]:
        """Those of all seeds."""
        return self.trainer.seeds.gaussians()

    @cached_property
    def _superblock(self) -> NDArray[np.int64]:
        """The superblock [N] that each seed's centre lies in, row by row."""
        _, height, width = self.texture.target.shape
        columns, rows = roots_of(width, height)
        column, row = self.trainer.seeds.layout.centre.astype(np.int64).T >> ROOT_LOG
        superblock: NDArray[np.int64] = np.minimum(row, rows - 1) * columns + np.minimum(column, columns - 1)
        return superblock

    def _ranks(self) -> F64:
        """Each seed's rank [N] among those of its superblock by its energy, faintest first, above 0 and below 1."""
        counts = np.bincount(self._superblock)
        order = np.lexsort((self.trainer.seeds.energy(), self._superblock))
        before = np.cumsum(counts) - counts
        ranks = np.empty(len(order))
        ranks[order] = np.arange(len(order)) + 0.5
        return (ranks - before[self._superblock]) / counts[self._superblock]
