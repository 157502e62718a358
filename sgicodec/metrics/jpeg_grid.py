"""The grid of a picture that was a JPEG file once: where its blocks of 8×8 pixels lie.

JPEG leaves most cosines of a block at zero, on its own grid alone, so that more of them are next to nothing there than
on the same grid a few pixels beside (docs/notes/2026-11-texture.md).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_SIDE = 8
_MAX_BLOCKS = 14
"""That are looked at along each side of a tile."""
_NOTHING = 1.0
"""Amplitude, levels, below which a cosine is rounding alone."""
_FEWER = 0.88
"""Share of other cosines on a JPEG's grid in that on the usual one, at most: 0.90 where its quality was 97, from which
nothing is gained."""


def jpeg_grid(luma: NDArray[np.float64]) -> tuple[int, int] | None:
    """The grid of a plane [H, W] in levels of 255: how many pixels of its first blocks lie left of it and above it, 0
    to 7; None where it was no JPEG, or one whose grid gains nothing.
    """
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
    return int(-left % _SIDE), int(-top % _SIDE)


def jpeg_saving(luma: NDArray[np.float64], grid: tuple[int, int]) -> float:
    """Bits that whole levels of a plane [H, W] take less as cosines of JPEG's blocks than as differences to what their
    neighbours predict, by the entropy of each: fewer than 0 for text and line art, even if it was a JPEG file.
    """
    left, top = (-before % _SIDE for before in grid)
    rows, columns = ((length - first) // _SIDE for length, first in zip(luma.shape, (top, left), strict=True))
    plane = luma[top : top + _SIDE * rows, left : left + _SIDE * columns].astype(np.float32)
    blocks = plane.reshape(rows, _SIDE, columns, _SIDE).transpose(0, 2, 1, 3).reshape(-1, _SIDE * _SIDE)
    cosines = np.rint(blocks @ _cosines())
    cosines[1:, 0] -= cosines[:-1, 0].copy()
    levels = np.rint(plane)
    above, before, corner = levels[:-1, 1:], levels[1:, :-1], levels[:-1, :-1]
    predicted = np.clip(above + before - corner, np.minimum(above, before), np.maximum(above, before))
    rest, is_flat = levels[1:, 1:] - predicted, (above == before) & (above == corner)
    as_cosines = sum(_bits(of_frequency) for of_frequency in cosines.T)
    return _bits(rest[is_flat]) + _bits(rest[~is_flat]) - as_cosines


def _bits(numbers: NDArray[np.float32]) -> float:
    """What whole numbers take by their entropy."""
    counts = np.unique(numbers, return_counts=True)[1]
    return float(-(counts * np.log2(counts / max(1, numbers.size))).sum())


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
