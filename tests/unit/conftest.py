"""The odd pictures and small helpers that these tests share."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest


@pytest.fixture(scope="session")
def pictures() -> Path:
    """Folder of the odd pictures."""
    return Path(__file__).parents[1] / "data" / "pictures"


@pytest.fixture(scope="session")
def exif_blob() -> Callable[..., bytes]:
    """Builder of an EXIF blob, by hand: a maker, an orientation, and an EXIF directory with a lens model."""

    def build(orientation: int = 6, order: str = "<") -> bytes:
        head = b"II*\0" if order == "<" else b"MM\0*"
        row = struct.Struct(order + "HHI4s")
        place, short = struct.Struct(order + "I"), struct.Struct(order + "H2x")
        main = [
            row.pack(271, 2, 6, place.pack(50)),
            row.pack(274, 3, 1, short.pack(orientation)),
            row.pack(34665, 4, 1, place.pack(56)),
        ]
        lens = row.pack(42036, 2, 4, b"50m\0")
        count = struct.Struct(order + "H")
        return b"".join(
            [
                head,
                place.pack(8),
                count.pack(3),
                *main,
                place.pack(0),
                b"Maker\0",
                count.pack(1),
                lens,
                place.pack(0),
            ]
        )

    return build


@pytest.fixture(scope="session")
def noise() -> Callable[..., np.ndarray]:
    """Builder of random samples [H, W, C] that use the whole of their type."""

    def build(height: int, width: int, count: int, dtype: str, seed: int = 7) -> np.ndarray:
        random = np.random.default_rng(seed)
        if dtype == "float32":
            return random.normal(0.0, 100.0, (height, width, count)).astype(np.float32)
        return random.integers(0, np.iinfo(dtype).max, (height, width, count), dtype, endpoint=True)

    return build


@pytest.fixture(scope="session")
def save() -> Callable[..., Path]:
    """Writer of a file as OpenImageIO alone makes it.

    Attributes are written as keywords, `__` for their colon; `tile` is (width, height), `at` the place of the first
    pixel.
    """

    def build(
        path: Path, pixels: np.ndarray, tile: tuple[int, int] = (0, 0), at: tuple[int, int] = (0, 0), **hints: object
    ) -> Path:
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

    return build
