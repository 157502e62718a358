"""Inpainting: pixels that hold nothing get a smooth continuation of the colours around them, which costs few bits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["inpaint"]

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]


def inpaint(image: F32, empty: Mask) -> F32:
    """image [C, H, W] with the pixels of `empty` [H, W] continued from the others (push and pull, Gortler 1996).

    Without any other pixel it is zero.
    """
    weight = (~empty).astype(np.float32)
    return _filled(np.where(empty, np.float32(0), image), weight)


def _filled(image: F32, weight: F32) -> F32:
    """`image`, already multiplied by `weight`, where that is 1; continued where it is less."""
    if min(weight.shape) == 1 and max(weight.shape) == 1:
        return image
    if weight.min() >= 1:
        return image
    coarse_weight = _halved(weight[None])[0]
    scale = np.where(coarse_weight > 0, np.minimum(coarse_weight, 1) / np.maximum(coarse_weight, 1e-9), 0)
    coarse = _filled(_halved(image) * scale.astype(np.float32), np.minimum(coarse_weight, 1))
    rows, columns = weight.shape
    smooth = _doubled(_doubled(coarse, 1)[:, :rows], 2)[:, :, :columns]
    return np.asarray(image + (1 - weight) * smooth, np.float32)


def _halved(image: F32) -> F32:
    """Sums of 2×2 pixels [C, ⌈H/2⌉, ⌈W/2⌉]."""
    _, rows, columns = image.shape
    even = np.pad(image, ((0, 0), (0, rows % 2), (0, columns % 2)))
    return np.asarray(even[:, ::2, ::2] + even[:, 1::2, ::2] + even[:, ::2, 1::2] + even[:, 1::2, 1::2], np.float32)


def _doubled(image: F32, axis: int) -> F32:
    """Twice as long along an axis, linearly interpolated between the old centres."""
    old = np.moveaxis(image, axis, 0)
    padded = np.concatenate([old[:1], old, old[-1:]])
    new = np.empty((2 * len(old), *old.shape[1:]), np.float32)
    new[::2] = 0.75 * old + 0.25 * padded[:-2]
    new[1::2] = 0.75 * old + 0.25 * padded[2:]
    return np.moveaxis(new, 0, axis)
