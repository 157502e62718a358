"""Seed layouts: leaves of an adaptive quadtree, or a jittered grid, in Morton order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.arrays import F32, F64, I32
from sgicodec.model.distinct import distinct
from sgicodec.model.morton import canonical_order

ROOT_LOG = 6
"""log2 of the side in pixels of the quadtree's root cells."""


@dataclass(frozen=True)
class CellSums:
    """Sums over the cells of every level, from two pixels to roots; cells may reach beyond the picture, where all
    is zero.

    values: Σ w d by channel [C, rows, columns]; squares: Σ w |d|² [rows, columns]; weights: Σ w [rows, columns].
    """

    values: dict[int, F64]
    squares: dict[int, F64]
    weights: dict[int, F64]

    def held(self, level: int) -> F64:
        """|Σ w d|² / Σ w of each cell: the squared error that its weighted mean holds."""
        held: F64 = np.sum(self.values[level] ** 2, axis=0) / self.weights[level]
        return held


@dataclass(frozen=True)
class SeedLayout:
    """N seeds: corner [N, 2] (x, y) of each one's cell in pixels and log_size [N], log2 of the cell's side.

    Canonical order is the Morton order of the corners, coarse before fine where they coincide.
    """

    corner: I32
    log_size: NDArray[np.int8]

    def __len__(self) -> int:
        return len(self.corner)

    @property
    def cell(self) -> F32:
        """Side of each cell, pixels [N]."""
        return np.ldexp(np.float32(1), self.log_size.astype(np.int32))

    @property
    def centre(self) -> F32:
        """Centres of the cells, pixels [N, 2]."""
        return self.corner.astype(np.float32) + 0.5 * self.cell[:, None]

    @property
    def half_pixels(self) -> I32:
        """Centres of the cells in half pixels [N, 2]: always whole numbers."""
        return (2 * self.corner + (np.int32(1) << self.log_size.astype(np.int32))[:, None]).astype(np.int32)

    def take(self, keep: NDArray[np.generic]) -> SeedLayout:
        """The seeds that a mask or index array selects."""
        return SeedLayout(self.corner[keep], self.log_size[keep])

    def order(self) -> NDArray[np.intp]:
        """Indices that sort the seeds into canonical order."""
        return canonical_order(self.corner, self.log_size)


def uniform_layout(width: int, height: int, count: int, rng: np.random.Generator) -> SeedLayout:
    """`count` seeds of one pixel, one at a random place in each cell of a grid that covers the picture (paper); no more
    than there are pixels, and no two in one.
    """
    count = min(count, width * height)
    rows = max(1, min(height, round((count * height / width) ** 0.5)))
    per_row = np.diff(np.linspace(0, count, rows + 1).round().astype(np.int64))
    corners = []
    for row, columns in enumerate(per_row):
        top, bottom = row * height // rows, (row + 1) * height // rows
        left = np.arange(columns) * width // columns
        right = (np.arange(columns) + 1) * width // columns
        x = left + np.floor(rng.random(columns) * np.maximum(1, right - left))
        y = top + np.floor(rng.random(columns) * (bottom - top))
        corners.append(np.stack([np.minimum(x, width - 1), y], axis=1))
    x, y = np.concatenate(corners).astype(np.int64).T
    pixel = distinct(y * width + x)
    if len(pixel) < count:  # cells narrower than a pixel have met
        free = np.setdiff1d(np.arange(width * height), pixel, assume_unique=True)
        pixel = np.concatenate([pixel, rng.choice(free, count - len(pixel), replace=False)])
    corner = np.stack([pixel % width, pixel // width], axis=1).astype(np.int32)
    layout = SeedLayout(corner, np.zeros(count, np.int8))
    return layout.take(layout.order())


def adaptive_layout(detail: F32, threshold: float, min_log: int = 1, weights: F32 | None = None) -> SeedLayout:
    """Leaves of the quadtree that splits every cell whose squared deviation from its mean exceeds `threshold`.

    detail [C, H, W] is what seeds have to explain (the picture less its base layer); the deviation is summed over
    channels and pixels, which count as `weights` [H, W] say, so a threshold of n bits' worth of distortion makes the
    count follow from the rate.
    """
    _, height, width = detail.shape
    corners, sizes = [], []
    for level, leaves in _leaves(cell_sums(detail, ROOT_LOG, weights), threshold, min_log):
        y, x = np.nonzero(leaves)
        corner = np.stack([x, y], axis=1).astype(np.int32) << level
        inside = (corner[:, 0] < width) & (corner[:, 1] < height)
        corners.append(corner[inside])
        sizes.append(np.full(int(inside.sum()), level, np.int8))
    layout = SeedLayout(np.concatenate(corners), np.concatenate(sizes))
    return layout.take(layout.order())


def _leaves(sums: CellSums, threshold: float, min_log: int) -> Iterator[tuple[int, NDArray[np.bool_]]]:
    """Level by level from the roots, which of its cells are leaves."""
    alive = np.ones(sums.squares[ROOT_LOG].shape, bool)
    for level in range(ROOT_LOG, min_log - 1, -1):
        deviation = sums.squares[level] - sums.held(level)
        split = alive & (deviation > threshold) if level > min_log else np.zeros_like(alive)
        yield level, alive & ~split
        alive = split.repeat(2, axis=0).repeat(2, axis=1)


def cell_sums(detail: F32, root_log: int, weights: F32 | None = None, threads: int = 1) -> CellSums:
    """Sums of `detail` [C, H, W] over cells, pixels counting as `weights` [H, W] say, by default all as 1.

    Beside the picture pixels count as those of its border do, as if it went on with zeros.
    """
    levels = _native.cell_sums(detail, weights, root_log, threads)
    return CellSums(*(dict(enumerate(sums, 1)) for sums in zip(*levels, strict=True)))
