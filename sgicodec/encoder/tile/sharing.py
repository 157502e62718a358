"""Where seeds should show a picture and where texture does: weights of the seeds' squared errors.

Seeds take few bits for edges, since they are long and lie along them. Texture takes fewer for detail that has no
direction: leaves, water, tissue. The structure tensor tells one from the other. Where there is no direction, seeds
count less, so that fewer are placed and texture shows what they leave.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import TEXTURE_ROOT_LOG
from sgicodec.arrays import F32, F64
from sgicodec.fit.pyramid import pyramid
from sgicodec.model.layout import SeedLayout
from sgicodec.model.texture_symbols import roots_of

_FULL_COHERENCE, _OCTAVES = 0.82, 14.0
"""Coherence from which on seeds count in full, and the octaves by which they count less for each unit below it
(docs/notes/2026-11-texture-share.md, "One look at edges in place of a short fit")."""
MIN_WEIGHT = 1 / 32
"""The least weight."""
_MIN_STEPS = 1 / 4
"""The least part of a fit's steps (docs/notes/2026-11-ladder.md, "Few steps where there are few seeds")."""
_NO_MORE_STEPS, _ALL_STEPS = 0.2, 0.7
"""Mean weights of seeds up to which more steps than usual gain nothing, and from which on all are worth their time
(docs/notes/2026-11-ladder.md, "High efforts where seeds show the picture")."""
_CALM_BITS = 48.0
"""Bits of texture in a superblock. Where they would buy all of its detail, seeds count in full: there is nothing to
share."""


def seed_weights(target: F32, lmbda: float) -> F32:
    """Weights [H, W] up to 1 of the seeds' squared errors in a target [C, H, W], for an encode at λ."""
    octaves = np.clip(_OCTAVES * (coherence(target, lmbda) - _FULL_COHERENCE), np.log2(MIN_WEIGHT), 0.0)
    return _of_pixels(np.exp2(smoothed(octaves, _BLEND)), target.shape[1:])


def part_of_steps(steps: int, usual: int, layout: SeedLayout, weights: F32) -> float:
    """Part of a fit's steps that is worth its time, for seeds that begin in this layout.

    All are where there is a seed for each superblock of texture, each counted by the weight [H, W] in its cell's
    middle, and fewer where there are fewer, _MIN_STEPS at least. Of those beyond the usual number, fewer are where the
    mean weight is small.
    """
    height, width = weights.shape
    x, y = (np.minimum(layout.corner[:, axis] + layout.cell / 2, side - 1) for axis, side in ((0, width), (1, height)))
    seeds = float(weights[y.astype(np.intp), x.astype(np.intp)].sum())
    part = float(min(max(seeds * (1 << 2 * TEXTURE_ROOT_LOG) / (width * height), _MIN_STEPS), 1.0))
    more = (float(weights.mean()) - _NO_MORE_STEPS) / (_ALL_STEPS - _NO_MORE_STEPS)
    few = min(steps, usual)
    return part * (few + min(max(more, 0.0), 1.0) * (steps - few)) / steps


def coherence(target: F32, lmbda: float) -> F64:
    """How much one direction prevails in each superblock of texture [rows, columns], 0 for not at all to 1.

    (λ₁ − λ₂) / (λ₁ + λ₂) of each channel's structure tensor over windows of 8×8 pixels, the mean by its trace (Bigün
    and Granlund 1987), at half the size, which takes out single pixels' noise.
    """
    _, height, width = target.shape
    columns, rows = roots_of(width, height)
    half = pyramid(target, 2)[1]
    room = [(0, 0), (0, rows * _HALF_BLOCK - half.shape[1]), (0, columns * _HALF_BLOCK - half.shape[2])]
    slopes = [np.gradient(half, axis=axis) if half.shape[axis] > 1 else np.zeros_like(half) for axis in (1, 2)]
    down, across = (np.pad(slope, room) for slope in slopes)
    yy, xx, yx = (_sums(product, _WINDOW) for product in (down * down, across * across, down * across))
    calm = lmbda * _CALM_BITS
    directed, all_ = (
        smoothed(_sums(part, _HALF_BLOCK // _WINDOW).sum(axis=0), _NEAR) + calm
        for part in (np.hypot(yy - xx, 2 * yx), yy + xx)
    )
    result: F64 = directed / all_
    return result


def _sums(planes: NDArray[np.floating], side: int) -> F64:
    """Sums over squares of planes [C, H, W]."""
    channels, height, width = planes.shape
    rows = planes.reshape(channels, height // side, side, width).sum(axis=2, dtype=np.float64)
    return np.asarray(rows.reshape(channels, height // side, width // side, side).sum(axis=3))


def smoothed(plane: F64, sigma: float) -> F64:
    """A plane convolved with a Gaussian of this σ, in its samples, mirrored at its borders."""
    reach = int(4 * sigma + 0.5)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        width = [(0, 0), (0, 0)]
        width[axis] = (reach, reach)
        padded, size = np.pad(plane, width, mode="symmetric"), plane.shape[axis]
        plane = sum(k * np.take(padded, range(i, i + size), axis) for i, k in enumerate(kernel))  # type: ignore[assignment]
    return plane


def _of_pixels(weights: F64, shape: tuple[int, ...]) -> F32:
    """Superblocks' weights for each pixel [H, W], linear between their centres."""
    side = 1 << TEXTURE_ROOT_LOG
    for axis in (0, 1):
        at = np.clip((np.arange(shape[axis]) + 0.5) / side - 0.5, 0, weights.shape[axis] - 1)
        low = np.minimum(at.astype(np.int64), max(weights.shape[axis] - 2, 0))
        high = np.minimum(low + 1, weights.shape[axis] - 1)
        part = (at - low).reshape((-1, 1) if axis == 0 else (1, -1))
        weights = (1 - part) * weights.take(low, axis) + part * weights.take(high, axis)
    return np.ascontiguousarray(weights, np.float32)


_HALF_BLOCK, _WINDOW = 1 << (TEXTURE_ROOT_LOG - 1), 4
"""Sides of a superblock and of a window of the structure tensor, at half the size."""
_NEAR, _BLEND = 0.7, 0.5
"""σ in superblocks: the tensor is smoothed with the first, the weights' logarithms with the second."""
