"""A part of a picture as the bytes of a JPEG, PNG, WebP or TIFF file."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sgicodec.picture import Picture, to_rgb8

if TYPE_CHECKING:
    from PIL.Image import Image

    from sgicodec.decoder.stream import Region, Stream

FORMATS = {"jpg": "image/jpeg", "png": "image/png", "webp": "image/webp", "tif": "image/tiff"}
"""Extensions, and media types."""

MAX_SIDES = {"jpg": 65500, "webp": 16383}
"""Pixels of a side that a format holds, where that is a limit."""

QUALITIES = ("default", "color", "gray", "bitonal")

_OPTIONS: Mapping[str, tuple[str, dict[str, Any]]] = {
    "jpg": ("JPEG", {"quality": 90}),
    "png": ("PNG", {"compress_level": 3}),
    "webp": ("WEBP", {"quality": 90, "method": 2}),
    "tif": ("TIFF", {"compression": "tiff_adobe_deflate"}),
}

_LARGEST_PROFILE = 1 << 16
"""Bytes of an ICC profile that goes with every picture; a longer one would outweigh a tile."""


@dataclass(frozen=True)
class Drawing:
    """What to draw. region: x, y, width, height inside the picture; size: width and height before the rotation, which
    is clockwise in degrees and comes after mirroring at the vertical axis.
    """

    region: Region
    size: tuple[int, int]
    format: str = "jpg"
    rotation: int = 0
    mirror: bool = False
    quality: str = "default"


def drawn(stream: Stream, drawing: Drawing) -> bytes:
    """The file. Raises StreamError, UsageError."""
    picture = stream.picture(drawing.region, size=drawing.size, dtype=np.uint8)
    buffer = io.BytesIO()
    name, options = _OPTIONS[drawing.format]
    icc = picture.metadata.icc
    image = _image(picture, drawing)
    if icc is not None and len(icc) <= _LARGEST_PROFILE and drawing.quality in ("default", "color"):
        is_gray = image.mode in ("L", "LA") and drawing.format != "webp"  # which has colours alone
        if is_gray == (icc[16:20] == b"GRAY"):
            options = options | {"icc_profile": icc}
    image.save(buffer, name, **options)
    return buffer.getvalue()


def _image(picture: Picture, drawing: Drawing) -> Image:
    from PIL import Image as images

    pixels = _pixels(picture, drawing.format)
    if drawing.mirror:
        pixels = pixels[:, ::-1]
    pixels = np.rot90(pixels, -drawing.rotation // 90)
    image = images.fromarray(np.ascontiguousarray(pixels[..., 0] if pixels.shape[2] == 1 else pixels))
    if drawing.quality == "gray":
        return image.convert("LA" if image.mode in ("LA", "RGBA") and drawing.format != "webp" else "L")
    if drawing.quality == "bitonal":
        image = image.convert("L").point(lambda level: 255 * (level >= 128))
        return image if drawing.format in ("jpg", "webp") else image.convert("1", dither=images.Dither.NONE)
    return image


def _pixels(picture: Picture, format_: str) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Samples [H, W, 1 to 4] that the format can hold: without alpha on black, of many bands the first three."""
    if picture.channels == "multi" or (picture.alpha is not None and format_ == "jpg"):
        return to_rgb8(picture)
    return picture.pixels
