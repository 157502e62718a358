"""What texture costs over each superblock of a tile, as it is searched and as it is estimated."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.tile.texture_steps import TUNINGS
from sgicodec.model.texture import ROOT_LOG
from sgicodec.model.texture_symbols import TextureSteps
from sgicodec.rdoq.texture import NO_SPLIT_SEARCH, TextureSearch, superblock_planes

__all__ = ["TextureCosts"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@dataclass(frozen=True)
class TextureCosts:
    """What texture costs over each superblock [rows, columns] in an encode at λ. target [C, H, W]: the picture less its
    base layer.
    """

    target: F32
    lmbda: float
    device: Device = ALL_CORES

    @cached_property
    def steps(self) -> TextureSteps:
        """Those of least squared error."""
        tuning = TUNINGS["psnr"]
        return tuning.steps(tuning.step(self.lmbda), len(self.target))

    def over(self, residual: F32) -> F64:
        """As the search finds it, over what seeds leave [C, H, W]."""
        search = TextureSearch(residual, self.device, NO_SPLIT_SEARCH)
        costs = search.costs(self.steps, TUNINGS["psnr"].squared_steps)
        return np.asarray(costs * np.square(self.steps.of_channels[0]), np.float64)

    def estimated_over(self, residual: F32) -> F64:
        """As it is estimated, in a tenth of the time: as if all blocks were cosine transforms of 16×16 pixels."""
        step = (self.lmbda / _ESTIMATED_STEPS) ** 0.5
        planes = superblock_planes(residual) / np.float32(step)
        channels, rows, columns = len(planes), planes.shape[1] >> ROOT_LOG, planes.shape[2] >> ROOT_LOG
        half = 1 << (ROOT_LOG - 1)
        blocks = planes.reshape(channels, 2 * rows, half, 2 * columns, half)
        cosines = _cosines(half)
        squares = np.square(cosines @ blocks.transpose(0, 1, 3, 2, 4) @ cosines.T)
        # λ times the bits of a symbol with its zeros, and the error that it leaves, in squared steps
        coded = 0.35 + 0.075 * np.log2(np.maximum(squares, 0.25))
        shape = channels, rows, 2, columns, 2, half, half
        sums = np.minimum(squares, coded).reshape(shape).sum((0, 2, 4, 5, 6), dtype=np.float64)
        return np.asarray(step * step * sums)

    @cached_property
    def without_seeds(self) -> F64:
        """As the search finds it over the target."""
        return self.over(self.target)


def _cosines(size: int) -> F32:
    """The orthonormal DCT-II [size, size]."""
    rows = np.cos(np.pi * np.outer(np.arange(size), np.arange(size) + 0.5) / size)
    rows[0] *= 0.5**0.5
    return np.asarray((2 / size) ** 0.5 * rows, np.float32)


_ESTIMATED_STEPS = 0.11
"""λ in squared steps where the cost of texture is estimated (docs/notes/2026-11-texture.md)."""
