"""For tests of scores of what is seen: parts of photographs, as JPEG too; gradients against central differences."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
import pytest
from data_files import DATA
from numpy.typing import NDArray
from PIL import Image

Rgb8 = NDArray[np.uint8]
F32 = NDArray[np.float32]


def photo(name: str) -> Rgb8:
    return np.asarray(Image.open(DATA / f"{name}.png").convert("RGB"))[20:181, 60:275]


def by_jpeg(pixels: Rgb8, quality: int) -> Rgb8:
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "JPEG", quality=quality)
    return np.asarray(Image.open(buffer))


def unit(pixels: Rgb8) -> F32:
    """8-bit [H, W, C] as [C, H, W] in 0..1."""
    return pixels.transpose(2, 0, 1).astype(np.float32, order="C") / np.float32(255)


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
