"""Gradients against central differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

__all__ = ["assert_slope"]

F32 = NDArray[np.float32]


def assert_slope(value: Callable[[F32], float], at: F32, gradient: F32, step: float, rel: float) -> None:
    """In each quarter of the pixels [C, H, W], along the gradient itself: a step that float32 can tell."""
    height, width = at.shape[1:]
    for top in (0, height // 2):
        for left in (0, width // 2):
            way = np.zeros_like(at)
            part = slice(None), slice(top, top + height // 2), slice(left, left + width // 2)
            way[part] = gradient[part] / np.abs(gradient[part]).max()
            there, back = (value((at + sign * step * way).astype(np.float32)) for sign in (1, -1))
            expected = (there - back) / (2 * step)
            assert float((gradient * way).sum()) == pytest.approx(expected, rel=rel)
