"""Which places of a picture are worth a look: where it is busiest, and where codecs differ most."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from sgicodec.bench.codec import Pixels8
from sgicodec.metrics.psnr import luma

Plane = npt.NDArray[np.float64]  # [H, W]
Place = tuple[int, int]  # x, y of the upper left corner

_FINE = 5  # pixels: what is smaller than this counts as busy
_STEP = 8  # pixels between the places that are tried


def busiest(original: Pixels8, width: int, height: int, taken: Sequence[Place] = ()) -> Place:
    """The window of the largest variance of fine detail in luma, off those that are taken."""
    plane = luma(original)
    fine = plane - _box(plane, _FINE)
    return _best(_window_means(fine**2, width, height), width, height, taken)


def most_different(
    original: Pixels8, decoded: Sequence[Pixels8], width: int, height: int, taken: Sequence[Place] = ()
) -> Place:
    """The window where the squared errors of the decoded pictures lie farthest apart, off those that are taken."""
    errors = [np.mean((original.astype(np.float64) - other) ** 2, axis=2) for other in decoded]
    means = np.stack([_window_means(error, width, height) for error in errors])
    return _best(means.max(axis=0) - means.min(axis=0), width, height, taken)


def _window_means(plane: Plane, width: int, height: int) -> Plane:
    """Means over all windows of a size, by their upper left corner [H - height + 1, W - width + 1]."""
    sums = np.zeros((plane.shape[0] + 1, plane.shape[1] + 1))
    sums[1:, 1:] = plane.cumsum(axis=0).cumsum(axis=1)
    totals = sums[height:, width:] - sums[:-height, width:] - sums[height:, :-width] + sums[:-height, :-width]
    return np.asarray(totals / (width * height))


def _box(plane: Plane, side: int) -> Plane:
    """Means over squares around every pixel; the border is repeated."""
    return _window_means(np.pad(plane, side // 2, mode="edge"), side, side)


def _best(values: Plane, width: int, height: int, taken: Sequence[Place]) -> Place:
    """The corner of the largest value on a coarse grid. A window may reach over a taken one where all do."""
    tried = values[::_STEP, ::_STEP].copy()
    y, x = (np.arange(count) * _STEP for count in tried.shape)
    for left, top in taken:
        over = (np.abs(y - top) < height)[:, None] & (np.abs(x - left) < width)
        if not over.all():
            tried[over] = -np.inf
    row, column = np.unravel_index(int(tried.argmax()), tried.shape)
    return int(column) * _STEP, int(row) * _STEP
