"""Pictures for tests of scores that say what is seen: parts of photographs, and what JPEG makes of them."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

DATA = Path(__file__).parents[1] / "data"
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
