"""Pixels of a photograph and of a page of text, and means over them."""

from __future__ import annotations

import numpy as np
from data_files import crop
from numpy.typing import NDArray


def photo(width: int, height: int) -> NDArray[np.uint8]:
    return crop("kodim23", np.s_[:height, :width]).pixels


def text(width: int, height: int) -> NDArray[np.uint8]:
    """Lines of a few letters of 6×8 pixels with soft edges, dark on light."""
    rng = np.random.default_rng(8)
    letters = 255 - rng.choice([0] * 7 + [60, 200, 230], (9, 8, 6)).astype(np.uint8)
    letters[:, :, 5] = letters[:, 7] = 255
    lines = letters[rng.integers(0, 9, (-(-height // 8), -(-width // 6)))].transpose(0, 2, 1, 3)
    page = lines.reshape(lines.shape[0] * 8, -1)[:height, :width]
    return np.ascontiguousarray(np.stack([page, page, 255 - (255 - page) // 2], axis=2))


def means(rows: NDArray[np.float64], start: float, step: float, count: int) -> NDArray[np.float64]:
    """Of `count` spans of rows, each `step` long."""
    total = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0)])
    ends = start + step * np.arange(count + 1)
    whole = np.minimum(ends.astype(int), len(rows) - 1)
    sums = total[whole] + (ends - whole)[:, None, None] * rows[whole]
    return np.asarray(np.diff(sums, axis=0) / step)
