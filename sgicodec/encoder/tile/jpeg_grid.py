"""The grid of a picture that was a JPEG file once: where its blocks of 8×8 pixels lie.

JPEG leaves most cosines of a block at zero, on its own grid alone, so that more of them are next to nothing there than
on the same grid a few pixels beside (docs/notes/2026-11-texture.md).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.model.texture_symbols import TextureGrid

__all__ = ["jpeg_grid"]

_SIDE = 8
_MAX_BLOCKS = 14
"""That are looked at along each side of a tile."""
_NOTHING = 1.0
"""Amplitude, levels, below which a cosine is rounding alone."""
_FEWER = 0.88
"""Share of other cosines on a JPEG's grid in that on the usual one, at most: 0.90 where its quality was 97, from which
nothing is gained."""


def jpeg_grid(luma: NDArray[np.float64]) -> TextureGrid | None:
    """The grid of a plane [H, W] in levels of 255; None where it was no JPEG, or one whose grid gains nothing."""
    starts = [_starts(length) for length in luma.shape]
    if not all(len(some) for some in starts):
        return None
    windows = np.lib.stride_tricks.sliding_window_view(luma.astype(np.float32), (_SIDE, _SIDE))
    rows, columns = starts
    cosines = _cosines()
    others = np.empty((_SIDE, _SIDE))
    for y, x in np.ndindex(others.shape):
        blocks = windows[np.ix_(rows + y, columns + x)].reshape(-1, _SIDE * _SIDE)
        others[y, x] = (np.abs(blocks @ cosines) >= _NOTHING).mean()
    top, left = np.unravel_index(others.argmin(), others.shape)
    if others[top, left] >= _FEWER * np.median(others):
        return None
    return TextureGrid(True, int(-left % _SIDE), int(-top % _SIDE))


def _starts(length: int) -> NDArray[np.int64]:
    """Where the blocks that are looked at begin, which leave room for all grids."""
    count = max(0, (length - _SIDE + 1) // _SIDE)
    return _SIDE * np.unique(np.linspace(0, count - 1, min(count, _MAX_BLOCKS)).astype(np.int64))


def _cosines() -> NDArray[np.float32]:
    """The orthonormal cosines of a block, [pixel, frequency]."""
    k, t = np.arange(_SIDE)[:, None], np.arange(_SIDE) + 0.5
    waves = np.sqrt(2 / _SIDE) * np.cos(np.pi * k * t / _SIDE)
    waves[0] *= np.sqrt(0.5)
    return np.kron(waves, waves).T.astype(np.float32)
