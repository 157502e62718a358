"""Random texture layers."""

from __future__ import annotations

import numpy as np

from sgicodec.model.texture import LEAST_LOG, ROOT_LOG, TextureLayer


def random_cells(width: int, height: int, seed: int, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners and sizes of a random quadtree, `share` of whose leaves hold texture."""
    rng = np.random.default_rng(seed)
    cells: list[tuple[int, int, int]] = []

    def add(x: int, y: int, log_size: int) -> None:
        if x >= width or y >= height:
            return
        if log_size > LEAST_LOG and rng.random() < 0.6:
            half = 1 << (log_size - 1)
            for dy in (0, half):
                for dx in (0, half):
                    add(x + dx, y + dy, log_size - 1)
        elif rng.random() < share:
            cells.append((x, y, log_size))

    for y in range(0, height, 32):
        for x in range(0, width, 32):
            add(x, y, ROOT_LOG)
    found = np.array(cells)
    return found[:, :2].astype(np.int32), found[:, 2].astype(np.uint8)


def random_layer(channels: int, width: int, height: int, seed: int = 0, share: float = 0.8) -> TextureLayer:
    """Some cells are full of amplitudes; most have a few, in low frequencies."""
    rng = np.random.default_rng(seed + 1)
    corner, log_size = random_cells(width, height, seed, share)
    amplitudes = []
    for log in log_size.tolist():
        cell = rng.normal(size=(channels, 1 << log, 1 << log)) * 0.1
        if rng.random() < 0.8:
            down, across = rng.integers(0, 7, 2)
            cell[:, down:] = cell[:, :, across:] = 0
        amplitudes.append(cell.astype(np.float32).ravel())
    return TextureLayer((width, height), channels, corner, log_size, np.concatenate(amplitudes))
