"""Random samples, and files of them as OpenImageIO alone makes them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio

__all__ = ["noise", "save"]


def noise(height: int, width: int, count: int, dtype: str) -> np.ndarray:
    """Random samples [H, W, C] that use the whole of their type."""
    random = np.random.default_rng(7)
    if dtype == "float32":
        return random.normal(0.0, 100.0, (height, width, count)).astype(np.float32)
    return random.integers(0, np.iinfo(dtype).max, (height, width, count), dtype, endpoint=True)


def save(
    path: Path, pixels: np.ndarray, tile: tuple[int, int] = (0, 0), at: tuple[int, int] = (0, 0), **hints: object
) -> Path:
    """Writes a file whose attributes are the keywords, `__` for their colon, and whose first pixel is `at` a place."""
    height, width, count = pixels.shape
    name = {"float32": "float", "float16": "half", "float64": "double"}.get(str(pixels.dtype), str(pixels.dtype))
    spec = oiio.ImageSpec(width, height, count, name)
    spec.tile_width, spec.tile_height = tile
    spec.x, spec.y = at
    for hint, value in hints.items():
        spec.attribute(hint.replace("__", ":"), value)
    image = oiio.ImageOutput.create(str(path))
    assert image.open(str(path), spec), image.geterror()
    assert image.write_image(np.ascontiguousarray(pixels)), image.geterror()
    assert image.close()
    return path
