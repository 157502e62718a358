"""Steps of texture: how they follow from λ, for least squared error or for the eye, and how much coarser or finer those
of each superblock are.

A busy superblock hides errors, so that its steps may be coarser: by a power of its variance. A regular pattern is seen
where noise of its strength is not, even beside things that mask it: the ribs of bellows next to the blocks of a tyre.
Where steps would swallow it, they become as fine as it needs. Where it would need far finer ones, it is left to go:
bits do more elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import CONTRAST_LIMIT, TEXTURE_ROOT_LOG
from sgicodec.arrays import F64
from sgicodec.device import ONE_THREAD, Device
from sgicodec.metrics.local_variance import local_variance
from sgicodec.metrics.regular_pattern import BLOCK, RegularPatterns, regular_patterns
from sgicodec.model.texture_symbols import (
    LAPPED,
    MAX_SLOPE,
    SAME_STEP,
    TEXTURE_STEP_COUNT,
    TEXTURE_STEP_ZERO,
    TextureGrid,
    TextureIndices,
    root_blocks,
    texture_step_index,
)

Offsets = NDArray[np.int8]


@dataclass(frozen=True)
class TextureTuning:
    """How steps follow from λ."""

    squared_steps: float
    """λ in squared steps, where steps do not grow."""
    network: int
    """Number of the shipped network that restores what is rendered for the same end."""
    worth: float
    """Share of squared error up to which a restored tile is worth the third to half of its decode that restoration
    takes (docs/notes/2026-11-restoration.md)."""
    finer: int = 0
    """32nds of an octave by which the lowest frequency has a smaller step than λ says."""
    growth: tuple[float, float] = (0.0, 0.0)
    """Slopes of the first channel and of the others (see `TextureIndices`) where the lowest step is a grey level; they
    grow with its square root, as far as a stream can say."""
    colours: float = 1.0
    """Steps of colour differences grow with this power of the first channel's."""
    masking: float = 0.0
    """Steps grow with this power of the local standard deviation of luma, 0 for not at all (see `Masking`)."""

    def step(self, lmbda: float) -> int:
        """Index of the step for λ."""
        return max(0, texture_step_index(float((lmbda / _SQUARED_STEPS) ** 0.5)) - self.finer)

    def price(self, lmbda: float) -> float:
        """λ in squared steps of `step(lmbda)`: what rounding takes from the step, it gives to the price of bits."""
        nominal = 2.0 ** ((self.step(lmbda) + self.finer - TEXTURE_STEP_ZERO) / 32)
        return float(self.squared_steps * lmbda / (_SQUARED_STEPS * nominal**2))

    def steps(self, step: int, channels: int) -> TextureIndices:
        """Steps of all channels, of which the lowest is of this index."""
        step = min(max(step, 0), TEXTURE_STEP_COUNT - 1)
        colour = SAME_STEP + round((1.0 - self.colours) * (_EQUAL_STEPS - step) / 4)
        ratios = (colour,) * 2 + (SAME_STEP,) * (channels - 3) if channels >= 3 else (SAME_STEP,) * (channels - 1)
        root = min((255.0 * TextureIndices(step).of_channels.item()) ** 0.5, _MAX_ROOT)
        luma, chroma = (min(round(2 * growth * root), MAX_SLOPE) for growth in self.growth)
        return TextureIndices(step, ratios, (luma, chroma), has_contrast=self.masking > 0)


_SQUARED_STEPS = 0.085
"""λ in squared steps, measured on eight pictures: 0.11 (docs/notes/2026-11-texture.md) with steps 6/32 of an octave
larger, as dependent symbols want them (docs/notes/2026-11-luma-space.md)."""
_MAX_ROOT = 7.6
"""Square root of a step, grey levels, above which slopes stay: by eye, steeper ones soften."""
_EQUAL_STEPS = 460
"""Index of the step at which colour differences have the same, whatever power they follow: 165 grey levels."""

TUNINGS = {
    "psnr": TextureTuning(_SQUARED_STEPS, network=1, worth=1.0),
    "visual": TextureTuning(
        0.0927,
        network=2,
        worth=0.995,
        finer=45,
        growth=(1.5, 2.0),
        colours=7 / 8,
        masking=0.4,
    ),
}
"""By what an encode is tuned for. `finer`, `growth`, _EQUAL_STEPS: docs/notes/2026-11-equal-losses.md; `masking`:
2026-11-texture-visual.md; `worth`: 2026-11-restoration.md."""


_FLOOR, _USUAL = 7.7e-4, 3.9e-3
"""Variances of luma, samples²: what counts as flat, and where steps are what λ says."""
_MIN_DEVIATION = 0.5 / 255
"""Of a pattern, samples: fainter ones count as much."""
_KEPT = 4.0
"""Step at the frequency of a pattern, in its standard deviations, up to which it stays
(docs/notes/2026-11-regular-patterns.md)."""
_MAX_FINER, _LEFT = 1.5, 3.0
"""Octaves by which steps become finer for a pattern at most, and that it would need where it gets none
(docs/notes/2026-11-regular-patterns.md)."""
_BLOCKS = 2
"""Of a superblock that must show a pattern; fewer get their part."""


class Masking:
    """Step offsets for a picture with this luma [H, W], 0 to 255, None for squared error, which has none; on each of
    these grids.

    They depend on the pixels near a superblock alone and on no mean, so that tiles look the same.
    """

    def __init__(
        self,
        tuning: TextureTuning,
        luma: F64 | None,
        device: Device = ONE_THREAD,
        grids: Sequence[TextureGrid] = (LAPPED,),
    ) -> None:
        self._power, self._device, self._plane, self._grids = tuning.masking, device, luma, grids

    def offsets(self, steps: TextureIndices, grid: TextureGrid = LAPPED) -> Offsets | None:
        """Step offsets [rows, columns] for these steps on one of the grids, None where they play no part."""
        if not self._power:
            return None
        masked, patterns = self._analyses[grid]
        return _indices(masked - 4 * _finer(patterns, steps, masked))

    @cached_property
    def _analyses(self) -> dict[TextureGrid, tuple[Offsets, RegularPatterns]]:
        """Of each grid, looked for when they are needed first, which is not at the start of a fit."""
        plane, self._plane = self._plane, None
        assert plane is not None
        return {grid: self._analysis(grid.layer_planes(plane, "symmetric")) for grid in self._grids}

    def _analysis(self, plane: F64) -> tuple[Offsets, RegularPatterns]:
        """What masking says, and the patterns of each superblock [rows, columns, 16]."""
        octaves = 0.5 * self._power * np.log2((local_variance(plane / 255.0) + _FLOOR) / _USUAL)
        masked = _indices(4 * root_blocks(octaves).mean(axis=(1, 3)))
        patterns = regular_patterns(plane, self._device)
        blocks = (patterns.certainty, patterns.deviation, patterns.frequency)
        return masked, RegularPatterns(*(_by_superblock(part, masked.shape) for part in blocks))


def _finer(patterns: RegularPatterns, steps: TextureIndices, masked: Offsets) -> F64:
    """Octaves [rows, columns] by which the steps of these offsets are too coarse for patterns."""
    step = steps.at_frequency(patterns.frequency) * 2.0 ** (masked[..., None] / 4)
    deviation = np.maximum(patterns.deviation / 255.0, _MIN_DEVIATION)
    octaves = np.log2(np.maximum(step / (_KEPT * deviation), 1.0))
    wanted = np.minimum(octaves, np.maximum(0.0, _MAX_FINER * (_LEFT - octaves) / (_LEFT - _MAX_FINER)))
    return np.asarray(np.sort(patterns.certainty * wanted)[..., -_BLOCKS:].mean(axis=-1))


def _indices(quarters: NDArray[np.floating] | Offsets) -> Offsets:
    """Quarters of an octave as a stream can state them."""
    return np.clip(np.rint(quarters), -CONTRAST_LIMIT, CONTRAST_LIMIT).astype(np.int8)


def _by_superblock(blocks: F64, shape: tuple[int, ...]) -> F64:
    """Values of blocks [rows of blocks, columns of blocks] by superblock [rows, columns, 16], 0 beyond the picture."""
    rows, columns = shape
    side = (1 << TEXTURE_ROOT_LOG) // BLOCK
    whole = np.pad(blocks, [(0, count * side - length) for count, length in zip(shape, blocks.shape, strict=True)])
    return whole.reshape(rows, side, columns, side).transpose(0, 2, 1, 3).reshape(rows, columns, side * side)
