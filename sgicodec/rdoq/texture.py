"""The texture layer over a decoded model: what is left of the picture, as cosines of least error plus λ times bits."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import TextureAmplitudes, cheapest_colours
from sgicodec.arrays import F32
from sgicodec.device import ALL_CORES, Device
from sgicodec.model.texture_symbols import (
    LAPPED,
    SAME_COLOURS,
    TextureGrid,
    TextureIndices,
    TextureSymbols,
    roots_of,
    whole_roots,
)

SPLIT_SEARCH_MARGIN, NO_SPLIT_SEARCH = 1.06, 1.0
"""`split_margin` of a search: the usual one, and the least, which takes two thirds of the time for 1 % more bytes
(docs/notes/2026-11-encode-speed.md has 1.03 to 1.06)."""


def superblock_planes(
    residual: F32, beyond: Literal["symmetric", "constant"] = "symmetric", grid: TextureGrid = LAPPED
) -> F32:
    """A residual [C, H, W], mirrored, or with zeros, to fill whole superblocks [C, 32 rows, 32 columns] of a grid."""
    return np.ascontiguousarray(whole_roots(grid.layer_planes(residual, beyond), beyond), np.float32)


def colours_for(
    residual: F32,
    steps: TextureIndices,
    squared_steps: float,
    offsets: NDArray[np.int8] | None = None,
    device: Device = ALL_CORES,
    grid: TextureGrid = LAPPED,
) -> tuple[int, int, int]:
    """The colours in which a layer for a residual [C, H, W] costs least, about; the others: see `TextureSearch`."""
    channels, height, width = residual.shape
    if channels < 3:
        return SAME_COLOURS
    columns, rows = roots_of(*grid.layer_size((width, height)))
    shown = np.zeros((rows, columns), np.int8) if offsets is None else offsets
    planes = superblock_planes(residual, grid=grid)
    return cheapest_colours(planes, shown, steps, squared_steps, grid.separate, device.threads)


class TextureSearch:
    """Searches layers for what a tile leaves over.

    residual [C, H, W]: the tile less what is rendered. split_margin: a block is tried whole, or
    divided, where an estimate says that it costs at most this many times what the other does. correction [C, H, W]:
    what is shown anyhow. colours: of the layers (see `TextureIndices`). grid: theirs.
    """

    def __init__(
        self,
        residual: F32,
        device: Device = ALL_CORES,
        split_margin: float = SPLIT_SEARCH_MARGIN,
        correction: F32 | None = None,
        colours: tuple[int, int, int] = SAME_COLOURS,
        grid: TextureGrid = LAPPED,
    ) -> None:
        _, height, width = residual.shape
        self.residual, self.size, self.split_margin, self.device = residual, (width, height), split_margin, device
        self.colours, self.grid = colours, grid
        layer_size = grid.layer_size(self.size)
        columns, rows = roots_of(*layer_size)
        self._shape = rows, columns
        wanted = residual if correction is None else residual - correction
        planes = superblock_planes(wanted, grid=grid)
        self._amplitudes = TextureAmplitudes(planes, layer_size, device.threads, colours, grid.separate)

    def excluding(self, correction: F32) -> TextureSearch:
        """The search for layers to which restoration adds this correction [C, H, W]."""
        return TextureSearch(self.residual, self.device, self.split_margin, correction, self.colours, self.grid)

    def at(
        self,
        steps: TextureIndices,
        squared_steps: float,
        offsets: NDArray[np.int8] | None = None,
        blocks: TextureSymbols | None = None,
    ) -> TextureSymbols | None:
        """The layer for these steps, None where nothing is worth its bits. squared_steps: λ in squared steps; offsets:
        of each superblock's steps; blocks: a layer whose blocks are taken as they are, which is faster than to choose
        them.
        """
        division = None if blocks is None else blocks.log_size
        shown, margin = self._offsets(offsets), self.split_margin
        parts, counts, excess = self._amplitudes.search(shown, steps, squared_steps, margin, division)
        added = tuple(_excess_index(sum_ / count) if count else 8 for count, sum_ in zip(counts, excess, strict=True))
        one, two, more = added
        layer = TextureSymbols(
            self.size,
            replace(steps, excess=(one, two, more), colours=self.colours),
            *parts,
            self.grid,
        )
        return None if layer.is_empty else layer

    def move(
        self,
        gradient: F32,
        steps: TextureIndices,
        offsets: NDArray[np.int8] | None,
        mean: float,
        limit: float,
        blocks: TextureSymbols | None = None,
    ) -> None:
        """Moves what layers should show up the gradient of a score in the samples [C, H, W], a little.

        An amplitude moves by its step times what a step of it gains, in units in which the mean of that is `mean`, at
        most `limit` of them; one below a step moves as much less, for it cannot be shown. blocks: a layer whose blocks
        alone are moved, where those that follow take them as they are.
        """
        planes = superblock_planes(gradient, "constant", self.grid)
        division = None if blocks is None else blocks.log_size
        self._amplitudes.move(planes, self._offsets(offsets), steps, mean, limit, division)

    def estimate(self, steps: TextureIndices, squared_steps: float, offsets: NDArray[np.int8] | None) -> float:
        """What the best layer costs about, error and bits together, in squared steps; the others: see `at`."""
        return self._amplitudes.estimate(self._offsets(offsets), steps, squared_steps)

    def _offsets(self, offsets: NDArray[np.int8] | None) -> NDArray[np.int8]:
        return np.zeros(self._shape, np.int8) if offsets is None else offsets


def _excess_index(excess: float) -> int:
    return int(np.clip(np.rint(32 * excess) + 8, 0, 15))
