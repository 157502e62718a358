"""Contrasts of roots by what errors cost of a score: where symbols leave more of it, steps become finer.

Steps are best where a bit more gains as much everywhere. To first order, the errors of a root take from a score what
its gradient says of them. That falls with the square of the step, while each symbol that is not 0 takes about a bit
more for half the step. So all roots should lose as much of the score for each of their symbols.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.encoder.tile.sharing import smoothed
from sgicodec.model.texture_symbols import CONTRAST_LIMIT, TextureSymbols, root_blocks

__all__ = ["better_contrasts"]

F32 = NDArray[np.float32]

_PART = 0.25
"""Of the way to equal losses that contrasts go at a time: a gradient is noisy, and holds near by only."""
_MAX_AWAY = 4
"""Quarters of an octave that they may be away from those of the tuning."""
_SIGMA = 0.5
"""Over which losses and symbols are smoothed, in roots: neighbours that differ cost bits."""
_FEWEST_SYMBOLS = 128
"""Of a root that tells something. Where seeds do most of the work, contrasts stay."""
_MORE_SYMBOLS = 40
"""That count for what else a root's bits are."""
_MIN_LOSS = 0.2
"""Of a root, in means."""


def better_contrasts(
    contrast: NDArray[np.int8], usual: NDArray[np.int8], gain: F32, symbols: TextureSymbols
) -> NDArray[np.int8]:
    """The contrasts [rows, columns] of the next layer. contrast: of this one; usual: of the tuning; gain [H, W]: what
    the score would grow by, to first order, without the error of each pixel.

    Their mean over symbols stays, so that a layer takes about as many bits.
    """
    lost = root_blocks(gain.astype(np.float64), "constant").sum(axis=(1, 3))
    counts = lost != 0  # where no pixel counts, contrasts do not
    lost = smoothed(lost, _SIGMA)
    coded = root_blocks((symbols.symbols != 0).sum(axis=0), "constant").sum(axis=(1, 3), dtype=np.float64)
    count = smoothed(coded, _SIGMA)
    tells = counts & (count >= _FEWEST_SYMBOLS)
    least = _MIN_LOSS * float(lost.mean())
    if least <= 0 or not tells.any():
        return contrast
    weight = np.where(tells, count + _MORE_SYMBOLS, 0.0)
    octaves = 0.5 * np.log2(np.maximum(lost, least) / (count + _MORE_SYMBOLS))
    octaves = np.where(tells, octaves - np.average(octaves, weights=weight), 0.0)
    wanted = np.clip(contrast - 4 * _PART * octaves, usual - float(_MAX_AWAY), usual + float(_MAX_AWAY))
    return np.clip(np.rint(wanted), -CONTRAST_LIMIT, CONTRAST_LIMIT).astype(np.int8)
