"""What a caller has at hand becomes a Picture: arrays, images of Pillow, files."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from itertools import chain
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.errors import UsageError
from sgicodec.image.narrowed import narrowed
from sgicodec.image.reader import pictured, read, use_of
from sgicodec.image.used_range import RangeChoice
from sgicodec.metadata import density, embedded, icc, placement
from sgicodec.metadata.exif import PREFIX
from sgicodec.metadata.layouts import LAYOUTS, alpha_index
from sgicodec.metadata.motion import Motion
from sgicodec.picture import Metadata, Picture, full_range

_LAYOUT_OF_COUNT = {count: name for name, count in LAYOUTS.items()}


def as_picture(
    image: object,
    *,
    channels: str | None = None,
    sample_range: RangeChoice | None = None,
    nodata: float | None = None,
) -> Picture:
    """The picture of an array, an image of Pillow, or a picture file by its path, its bytes or a file object.

    channels: the layout of an array, by default gray, gray+alpha, rgb or rgba by its number of channels, else multi.
    sample_range: the samples that stand for 0 and 1, as for `read`. nodata: the samples of an array that were not
    measured; of a masked array those that its mask hides, too. Raises UsageError or PictureError.
    """
    if isinstance(image, Picture):
        if channels is not None or sample_range is not None or nodata is not None:
            raise UsageError("a Picture has its own channels, sample_range and nodata")
        return image
    is_pillow = hasattr(image, "getbands") and hasattr(image, "getexif")
    if is_pillow or hasattr(image, "__array__") or hasattr(image, "__array_interface__"):
        if not is_pillow:
            return array_picture(image, channels, sample_range, nodata)
        if channels is not None or nodata is not None:
            raise UsageError("channels and nodata are said of arrays; an image of Pillow has a mode")
        return pillow_picture(image, sample_range)
    if channels is not None or nodata is not None:
        raise UsageError("channels and nodata are said of arrays; a file has its own")
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
    array: object,
    channels: str | None = None,
    sample_range: RangeChoice | None = None,
    nodata: float | None = None,
) -> Picture:
    """The picture of samples [H, W] or [H, W, C]: uint8, uint16 or floats, which are kept as float32."""
    if nodata is not None and (isinstance(nodata, bool) or not isinstance(nodata, Real)):
        raise UsageError(f"nodata {nodata!r}; it must be a number")
    if isinstance(array, np.ma.MaskedArray):
        array, nodata = _unmasked(array, nodata)
    pixels = np.asarray(array)
    pixels = pixels.astype(pixels.dtype.newbyteorder("="), copy=False)
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    if pixels.ndim != 3:
        raise UsageError(f"an array of shape {pixels.shape}; a picture is [H, W] or [H, W, C]")
    rounding, stored = 0.0, pixels.dtype
    if pixels.dtype in (np.float16, np.float64):
        pixels, rounding = narrowed(pixels, nodata)
        if math.isinf(rounding):
            raise UsageError("an array of float64 has samples beyond float32")
    if pixels.dtype not in (np.uint8, np.uint16, np.float32):
        raise UsageError(f"an array of {pixels.dtype}; convert it to uint8, uint16 or float32 first")
    if nodata is not None and pixels.dtype.kind == "f":
        if math.isfinite(nodata) and abs(nodata) > float(np.finfo(stored).max):
            raise UsageError(f"nodata {nodata:g}, which no sample of {stored} can have")
        with np.errstate(over="ignore"):  # an infinity then, as are its samples
            nodata = float(np.float32(nodata))
    elif nodata is not None and not (0 <= nodata <= np.iinfo(pixels.dtype).max and nodata % 1 == 0):
        raise UsageError(f"nodata {nodata:g}, which no sample of {pixels.dtype} can have")
    layout = channels or _LAYOUT_OF_COUNT.get(pixels.shape[2], "multi")
    remark = None
    if (
        channels is None
        and alpha_index(layout) is not None
        and not use_of(pixels, layout, nodata, sample_range).opacity
    ):
        layout, remark = "multi", _NO_OPACITY
    if layout not in ("multi", *LAYOUTS):
        raise UsageError(f"channels {channels!r}; there are {', '.join(LAYOUTS)} and multi")
    picture = _picture(pixels, layout, sample_range, Metadata(), nodata)
    return replace(picture, remark=remark or picture.remark, rounding=rounding)


_NO_OPACITY = "the last of its channels is opaque nowhere, or more than that: it is taken for a band, not for alpha"


def _unmasked(array: np.ma.MaskedArray[Any, Any], nodata: float | None) -> tuple[NDArray[Any], float | None]:
    """The samples of a masked array, what is masked as nodata, and that value: the one given, of floats not-a-number,
    of integers the array's fill value or else one that no sample has. Raises UsageError where all values are taken.
    """
    samples, mask = np.array(array.data), np.ma.getmaskarray(array)
    if not mask.any():
        return samples, nodata
    if nodata is None and samples.dtype.kind == "f":
        nodata = float("nan")
    elif nodata is None:
        limits = np.iinfo(samples.dtype)
        taken = set(np.unique(samples[~mask]).tolist())
        for value in chain((int(array.fill_value), 0, int(limits.max)), range(int(limits.max))):
            if limits.min <= value <= limits.max and value not in taken:
                nodata = float(value)
                break
        else:
            raise UsageError(f"the mask of an array that uses all values of {samples.dtype}; give nodata")
    elif (samples[~mask] == nodata).any():
        raise UsageError(f"nodata {nodata:g} is a sample that is not masked")
    samples[mask] = nodata
    return samples, nodata


def pillow_picture(
    image: Any,
    sample_range: RangeChoice | None = None,
    *,
    turn: int | None = None,
    dpi: tuple[float, float] | None = None,
) -> Picture:
    """The upright picture of an image of Pillow, with its ICC profile, EXIF and XMP. turn, dpi: instead of its own
    orientation and resolution.
    """
    from PIL import ImageOps

    lost = _left_behind(image)
    if turn is not None or dpi is not None:
        image = _restated(image, turn, dpi)
    turn, size = image.getexif().get(_ORIENTATION), image.size
    turn = turn if turn in range(1, 9) else 1
    image = ImageOps.exif_transpose(image)
    exif, xmp = image.getexif().tobytes().removeprefix(PREFIX), image.info.get("xmp")
    pixels = _plain_mode(image)
    layout = _LAYOUT_OF_COUNT[pixels.shape[2]]
    profile, misfit = icc.fitting(image.info.get("icc_profile") or None, layout)
    lost += [misfit] if misfit else []
    blobs = Metadata(icc=profile, exif=exif if len(exif) > _EMPTY_EXIF else None, xmp=_bytes(xmp))
    stated = density.tags(density.per_inch(image.info.get("dpi")), blobs.exif)
    metadata = replace(
        embedded.moved(blobs, Motion(size[0], size[1], turn)), geo=placement.oriented(stated, turn, *size)
    )
    rounding = narrowed(np.array(image))[1] if image.mode == "I" else 0.0
    picture = _picture(pixels, layout, sample_range, metadata)
    remarks = "; ".join(text for text in (f"not kept: {', '.join(lost)}" if lost else None, picture.remark) if text)
    return replace(picture, rounding=rounding, remark=remarks or None)


def _left_behind(image: Any) -> list[str]:
    """What an image of Pillow holds that its picture does not."""
    frames = getattr(image, "n_frames", 1) - 1
    found = [f"{frames} other frames"] if frames > 1 else ["another frame"] if frames else []
    if image.mode in _OTHER:
        found.insert(0, f"{_OTHER[image.mode]} (RGB instead)")
    return found


def _restated(image: Any, turn: int | None, dpi: tuple[float, float] | None) -> Any:
    """A copy that states this orientation and resolution, as far as they are given."""
    image = image.copy()
    exif = image.getexif()
    if turn is not None:
        exif[_ORIENTATION] = turn
    if dpi is not None:
        image.info["dpi"] = dpi
        for tag in _RESOLUTION:
            exif.pop(tag, None)
    return image


_OTHER = {"CMYK": "inks", "LAB": "Lab", "HSV": "HSV", "YCbCr": "YCbCr"}
_ORIENTATION, _RESOLUTION = 274, (282, 283, 296)
_EMPTY_EXIF = 14
"""Bytes of a TIFF structure without a tag."""


def _plain_mode(image: Any) -> NDArray[Any]:
    """Samples [H, W, C] of gray, RGB or either with alpha, which lose nothing of the image that a screen shows."""
    if image.mode.startswith("I") or image.mode == "F":
        return _deep_gray(image)
    mode = "LA" if image.mode in ("L", "1", "LA", "La") else "RGBA"
    if not image.has_transparency_data:
        mode = mode.removesuffix("A")
    pixels = np.array(image if image.mode == mode else image.convert(mode))
    return pixels.reshape(*pixels.shape[:2], -1)


def _deep_gray(image: Any) -> NDArray[Any]:
    """Integers of 16 bits if they have no more, in any order of bytes, else floats; with alpha where one of them, the
    transparent one, is not shown.
    """
    stored = np.array(image)
    within = stored.dtype.kind in "iu" and 0 <= stored.min() <= stored.max() <= np.iinfo(np.uint16).max
    pixels = stored.astype(np.uint16 if within else np.float32)
    hidden = image.info.get("transparency")
    if not isinstance(hidden, int):
        return pixels[..., None]
    largest = full_range(pixels.dtype)[1]
    return np.stack([pixels, np.where(stored == hidden, 0, largest).astype(pixels.dtype)], axis=-1)


def _bytes(text: object) -> bytes | None:
    return (text.encode() if isinstance(text, str) else bytes(text)) if text else None  # type: ignore[call-overload, no-any-return]


def _picture(
    pixels: NDArray[Any],
    channels: str,
    sample_range: RangeChoice | None,
    metadata: Metadata,
    nodata: float | None = None,
) -> Picture:
    use = use_of(pixels, channels, nodata, sample_range)
    picture = pictured(np.ascontiguousarray(pixels), channels, use, nodata, metadata)
    return picture if nodata is None else replace(picture, blank=nodata)
