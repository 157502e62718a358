"""Contrasts of a picture's roots: how much coarser or finer their steps are than those of the layer.

A busy root hides errors, so that its steps may be coarser: by a power of its variance. A regular pattern is seen where
noise of its strength is not, even beside things that mask it: the ribs of bellows next to the blocks of a tyre. Where
steps would swallow it, they become as fine as it needs. Where it would need far finer ones, it is left to go: bits do
more elsewhere.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sgicodec.encoder.tile.texture_tuning import TextureTuning
from sgicodec.metrics.local_variance import local_variance
from sgicodec.metrics.psnr import luma
from sgicodec.metrics.regular_pattern import BLOCK, RegularPatterns, regular_patterns
from sgicodec.model.texture import ROOT_LOG
from sgicodec.model.texture_symbols import CONTRAST_LIMIT, TextureSteps, root_blocks

__all__ = ["TextureContrasts"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Contrasts = NDArray[np.int8]

_FLOOR, _USUAL = 7.7e-4, 3.9e-3
"""Variances of luma, samples²: what counts as flat, and where steps are what λ says."""
_MIN_DEVIATION = 0.5 / 255
"""Of a pattern, samples: fainter ones count as much."""
_KEPT = 4.0
"""Step at the frequency of a pattern, in its standard deviations, up to which it stays."""
_MAX_FINER, _LEFT = 1.5, 3.0
"""Octaves by which steps become finer for a pattern at most, and that it would need where it gets none."""
_BLOCKS = 2
"""Of a root that must show a pattern; fewer get their part."""


class TextureContrasts:
    """Contrasts for a picture [C, H, W], samples in 0..1.

    They depend on the pixels near a root alone and on no mean, so that tiles look the same.
    """

    def __init__(self, tuning: TextureTuning, picture: F32) -> None:
        self._masking = tuning.masking
        self._plane = luma(picture.transpose(1, 2, 0), peak=1.0) if self._masking else None

    def at(self, steps: TextureSteps) -> Contrasts | None:
        """Contrasts [rows, columns] for these steps, None where they play no part."""
        if not self._masking:
            return None
        masked, patterns = self._found
        return _indices(masked - 4 * _finer(patterns, steps, masked))

    @cached_property
    def _found(self) -> tuple[Contrasts, RegularPatterns]:
        """What masking says, and the patterns of each root [rows, columns, 16]: looked for when they are needed first,
        which is not at the start of a fit.
        """
        plane, self._plane = self._plane, None
        assert plane is not None
        octaves = 0.5 * self._masking * np.log2((local_variance(plane / 255.0) + _FLOOR) / _USUAL)
        masked = _indices(4 * root_blocks(octaves, "edge").mean(axis=(1, 3)))
        found = regular_patterns(plane)
        blocks = (found.certainty, found.deviation, found.frequency)
        return masked, RegularPatterns(*(_by_roots(part, masked.shape) for part in blocks))


def _finer(patterns: RegularPatterns, steps: TextureSteps, masked: Contrasts) -> F64:
    """Octaves [rows, columns] by which the steps of these contrasts are too coarse for patterns."""
    step = steps.at_frequency(patterns.frequency) * 2.0 ** (masked[..., None] / 4)
    deviation = np.maximum(patterns.deviation / 255.0, _MIN_DEVIATION)
    octaves = np.log2(np.maximum(step / (_KEPT * deviation), 1.0))
    wanted = np.minimum(octaves, np.maximum(0.0, _MAX_FINER * (_LEFT - octaves) / (_LEFT - _MAX_FINER)))
    return np.asarray(np.sort(patterns.certainty * wanted)[..., -_BLOCKS:].mean(axis=-1))


def _indices(quarters: NDArray[np.floating] | Contrasts) -> Contrasts:
    """Quarters of an octave as a stream can state them."""
    return np.clip(np.rint(quarters), -CONTRAST_LIMIT, CONTRAST_LIMIT).astype(np.int8)


def _by_roots(blocks: F64, shape: tuple[int, ...]) -> F64:
    """Values of blocks [rows of blocks, columns of blocks] by root [rows, columns, 16], 0 beyond the picture."""
    rows, columns = shape
    side = (1 << ROOT_LOG) // BLOCK
    whole = np.pad(blocks, [(0, count * side - length) for count, length in zip(shape, blocks.shape, strict=True)])
    return whole.reshape(rows, side, columns, side).transpose(0, 2, 1, 3).reshape(rows, columns, side * side)
