"""Random samples, files of them as each library makes them, and what is said of a file when it is opened."""

from __future__ import annotations

import io
import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from PIL import Image, ImageCms

from sgicodec import Picture, open_source, read, write

SRGB = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
"""An ICC profile."""


def noise(height: int, width: int, count: int, dtype: str) -> np.ndarray:
    """Random samples [H, W, C] that use the whole of their type."""
    random = np.random.default_rng(7)
    if dtype == "float32":
        return random.normal(0.0, 100.0, (height, width, count)).astype(np.float32)
    return random.integers(0, np.iinfo(dtype).max, (height, width, count), dtype, endpoint=True)


def packed(picture: Picture, format: str, **options: Any) -> bytes:
    """The file that sgicodec makes of a picture."""
    file = io.BytesIO()
    write(picture, file, format=format, **options)
    return file.getvalue()


def by_pillow(image: np.ndarray | Image.Image, format: str, **options: Any) -> bytes:
    """The file that Pillow makes of samples or of its image."""
    file = io.BytesIO()
    (image if isinstance(image, Image.Image) else Image.fromarray(image)).save(file, format, **options)
    return file.getvalue()


def was_jpeg(pixels: np.ndarray, quality: int, subsampling: int = 0) -> np.ndarray:
    """Pixels as a JPEG file keeps them."""
    return read(by_pillow(pixels, "JPEG", quality=quality, subsampling=subsampling)).pixels


def by_tifffile(samples: np.ndarray, **options: Any) -> bytes:
    """The file that tifffile makes of samples."""
    import tifffile  # an extra, which what tries a wheel does without

    file = io.BytesIO()
    tifffile.imwrite(file, samples, **options)
    return file.getvalue()


def notes_of(origin: Path | bytes, **options: Any) -> tuple[str, ...]:
    """What is said of a picture file when it is opened."""
    with open_source(origin, **options) as source:
        return source.notes


def save(
    path: Path,
    pixels: np.ndarray,
    tile: tuple[int, int] = (0, 0),
    at: tuple[int, int] = (0, 0),
    channels: Sequence[str] = (),
    **hints: object,
) -> Path:
    """Writes a file by OpenImageIO whose attributes are the keywords, `__` for their colon, whose first pixel is `at` a
    place, and whose channels have these names.
    """
    height, width, count = pixels.shape
    name = {"float32": "float", "float16": "half", "float64": "double"}.get(str(pixels.dtype), str(pixels.dtype))
    spec = oiio.ImageSpec(width, height, count, name)
    spec.tile_width, spec.tile_height = tile
    spec.x, spec.y = at
    spec.channelnames = tuple(channels) or spec.channelnames
    for hint, value in hints.items():
        spec.attribute(hint.replace("__", ":"), value)
    image = oiio.ImageOutput.create(str(path))
    assert image.open(str(path), spec), image.geterror()
    assert image.write_image(np.ascontiguousarray(pixels)), image.geterror()
    assert image.close()
    return path


def window_rows(width: int, height: int, tile: int, apron: int) -> Iterator[tuple[int, int, int, int]]:
    """x, y, width and height of every tile with its apron, row by row, as an encode reads a picture."""
    for y, x in itertools.product(range(0, height, tile), range(0, width, tile)):
        left, top = max(x - apron, 0), max(y - apron, 0)
        yield left, top, min(x + tile + apron, width) - left, min(y + tile + apron, height) - top
