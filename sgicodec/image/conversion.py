"""What a caller has at hand becomes a Picture: arrays, images of Pillow, files."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.errors import PictureError, UsageError
from sgicodec.image.extremes import Extremes
from sgicodec.image.reader import read
from sgicodec.metadata import density, embedded, placement
from sgicodec.metadata.layouts import LAYOUTS
from sgicodec.metadata.motion import Motion
from sgicodec.picture import Metadata, Picture, full_range

__all__ = ["array_picture", "as_picture"]

_LAYOUT_OF_COUNT = {count: name for name, count in LAYOUTS.items()}
_PLAIN_MODES = {"L": "gray", "LA": "gray+alpha", "RGB": "rgb", "RGBA": "rgba", "I;16": "gray", "F": "gray"}
"""Modes of Pillow whose samples are taken as they are."""


def as_picture(
    image: object, *, channels: str | None = None, sample_range: tuple[float, float] | None = None
) -> Picture:
    """The picture of an array, an image of Pillow, or a picture file by its path, its bytes or a file object.

    channels: the layout of an array, by default gray, gray+alpha, rgb or rgba by its number of channels, else multi.
    sample_range: the samples that stand for 0 and 1, as for `read`. Raises UsageError or PictureError.
    """
    if isinstance(image, Picture):
        if channels is not None or sample_range is not None:
            raise UsageError("a Picture has its own channels and sample_range")
        return image
    is_pillow = hasattr(image, "getbands") and hasattr(image, "getexif")
    if is_pillow or hasattr(image, "__array__") or hasattr(image, "__array_interface__"):
        picture = _pillow_picture(image, sample_range) if is_pillow else array_picture(image, channels, sample_range)
        if is_pillow and channels is not None:
            raise UsageError("channels is said of arrays; an image of Pillow has a mode")
        return picture
    if channels is not None:
        raise UsageError("channels is said of arrays; a file has its own")
    if isinstance(image, os.PathLike):
        image = Path(image)
    if isinstance(image, bytearray | memoryview):
        image = bytes(image)
    if not (isinstance(image, str | Path | bytes) or hasattr(image, "read")):
        raise UsageError(
            f"{type(image).__name__} is no picture; give an array, an image of Pillow, a Picture or a path"
        )
    return read(image, sample_range=sample_range)  # type: ignore[arg-type]


def array_picture(
    array: object, channels: str | None = None, sample_range: tuple[float, float] | None = None
) -> Picture:
    """The picture of samples [H, W] or [H, W, C]: uint8, uint16 or floats, which are kept as float32."""
    pixels = np.asarray(array)
    pixels = pixels.astype(pixels.dtype.newbyteorder("="), copy=False)
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    if pixels.ndim != 3:
        raise UsageError(f"an array of shape {pixels.shape}; a picture is [H, W] or [H, W, C]")
    if pixels.dtype in (np.float16, np.float64):
        pixels = _as_float32(pixels)
    if pixels.dtype not in (np.uint8, np.uint16, np.float32):
        raise UsageError(f"an array of {pixels.dtype}; convert it to uint8, uint16 or float32 first")
    if sample_range is not None and pixels.dtype == np.float32 and np.isnan(pixels).any():
        raise PictureError("the array holds samples that are not a number; replace them by numbers first")
    layout = channels or _LAYOUT_OF_COUNT.get(pixels.shape[2], "multi")
    if layout != "multi" and layout not in LAYOUTS:
        raise UsageError(f"channels {channels!r}; there are {', '.join(LAYOUTS)} and multi")
    return _picture(pixels, layout, sample_range, Metadata())


def _as_float32(pixels: NDArray[Any]) -> NDArray[Any]:
    with np.errstate(over="ignore"):
        narrow = pixels.astype(np.float32)
    if np.isinf(narrow).any() and not np.isinf(pixels).any():
        raise UsageError("an array of float64 has samples beyond float32")
    return narrow


def _pillow_picture(image: Any, sample_range: tuple[float, float] | None) -> Picture:
    """The upright picture of an image of Pillow, with its ICC profile, EXIF and XMP."""
    from PIL import ImageOps

    turn, size = image.getexif().get(_ORIENTATION), image.size
    turn = turn if turn in range(1, 9) else 1
    image = ImageOps.exif_transpose(image)
    exif, xmp = image.getexif().tobytes().removeprefix(b"Exif\0\0"), image.info.get("xmp")
    icc = image.info.get("icc_profile")
    if image.mode not in _PLAIN_MODES:
        converted = _plain_mode(image)
        icc = icc if converted.mode.startswith(image.mode[:1]) else None  # of other colours
        image = converted
    blobs = Metadata(icc=icc or None, exif=exif if len(exif) > _EMPTY_EXIF else None, xmp=_bytes(xmp))
    stated = density.tags(density.per_inch(image.info.get("dpi")), blobs.exif)
    metadata = replace(
        embedded.moved(blobs, Motion(size[0], size[1], turn)), geo=placement.oriented(stated, turn, *size)
    )
    pixels = np.array(image)
    return _picture(pixels.reshape(*pixels.shape[:2], -1), _PLAIN_MODES[image.mode], sample_range, metadata)


_ORIENTATION = 274
_EMPTY_EXIF = 14
"""Bytes of a TIFF structure without a tag."""


def _plain_mode(image: Any) -> Any:
    """The image in a mode that loses nothing of it that a screen shows."""
    if image.mode.startswith("I"):
        if image.getextrema()[0] < 0 or image.getextrema()[1] > np.iinfo(np.uint16).max:
            raise UsageError(f"an image of mode {image.mode} has samples beyond 16 bits")
        return image.convert("I;16")
    if image.mode == "1":
        return image.convert("L")
    has_alpha = image.has_transparency_data
    return image.convert("RGBA" if has_alpha else "RGB")


def _bytes(text: object) -> bytes | None:
    return (text.encode() if isinstance(text, str) else bytes(text)) if text else None  # type: ignore[call-overload, no-any-return]


def _picture(
    pixels: NDArray[Any], channels: str, sample_range: tuple[float, float] | None, metadata: Metadata
) -> Picture:
    if sample_range is None and pixels.dtype.kind == "u":
        sample_range = full_range(pixels.dtype)
    elif sample_range is None:
        found = Extremes(channels, None)
        found.add(pixels)
        sample_range = found.range()
    return Picture(np.ascontiguousarray(pixels), channels, sample_range, metadata)
