"""Reading pictures: anything that OpenImageIO reads, whole or refused."""

from __future__ import annotations

import mmap
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..errors import PictureError
from . import embedded, ifd, png
from .alpha import unassociate
from .orientation import is_sideways, upright
from .picture import Metadata, Picture, alpha_index, full_range
from .source import Source, first_line, on_disk

if TYPE_CHECKING:
    from OpenImageIO import ImageInput, ImageSpec

__all__ = ["MAX_SAMPLES", "Probe", "probe", "read"]

MAX_SAMPLES = 1 << 31
"""Default cap on width × height × channels."""

_STREAM_SIGNATURE = b"\x89SGI\r\n\x1a\n"
_LAB_PHOTOMETRICS = (8, 9, 10)
_FLOATS = ("half", "float", "double")
_INTEGERS = ("int8", "int16", "int", "uint")

_ASSOCIATED = ("openexr", "tiff")
"""Formats that store premultiplied alpha unless OpenImageIO says that this file does not."""

_SECOND_IS_ALPHA = ("sgi", "targa")
"""Formats whose second of two channels is alpha although OpenImageIO does not name it so."""

_ALREADY_UPRIGHT = ("jpegxl",)
"""Formats whose library turns the pixels itself; their EXIF orientation must be ignored (ISO/IEC 18181-2
§9.2).
"""


@dataclass(frozen=True)
class Probe:
    """What a picture's header says: upright size in pixels, layout, channel count, and the dtype that `read`
    gives.
    """

    width: int
    height: int
    channels: str
    count: int
    dtype: np.dtype[Any]


def read(source: Source, *, max_samples: int = MAX_SAMPLES, sample_range: tuple[float, float] | None = None) -> Picture:
    """Read the first image of a file, of bytes, or of a stream from where it stands.

    sample_range states which colour samples stand for 0 and 1. Without it integers use the full range of
    their type, floats the range that they are found to have.

    Raises PictureError, one line that names the source, for what cannot be read whole and faithfully or has
    more than max_samples samples; UsageError for a range that is none.
    """
    with on_disk(source) as path:
        exif, xmp = _examine(path)
        image = _open(path)
        spec, kind = image.spec(), image.format_name()
        header = _header(spec, kind)
        if spec.width * spec.height * spec.nchannels > max_samples:
            raise PictureError(
                f"{spec.width} × {spec.height} pixels of {spec.nchannels} channels are more than the cap of "
                f"{max_samples} samples"
            )
        pixels = _pixels(image, spec, path).astype(header.dtype, copy=False)
        if alpha_index(header.channels) is not None and _is_associated(spec, kind):
            pixels = unassociate(pixels)
        metadata = Metadata(_icc(spec, header.channels), exif, xmp)
        if pixels.dtype.kind == "f" and np.isnan(pixels).any():
            raise PictureError("it holds samples that are not a number; replace them by numbers first")
        sample_range = sample_range or _range(pixels, header.channels)
        return Picture(upright(pixels, _orientation(spec, kind)), header.channels, sample_range, metadata)


def probe(source: Source) -> Probe:
    """Read a picture's header, not its pixels. Raises PictureError as `read` does."""
    with on_disk(source) as path:
        _examine(path)
        image = _open(path)
        return _header(image.spec(), image.format_name())


def _examine(path: Path) -> tuple[bytes | None, bytes | None]:
    """EXIF and XMP of the file; raises PictureError for what its bytes alone rule out."""
    if path.stat().st_size == 0:
        raise PictureError("the file is empty")
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        if data[:8] == _STREAM_SIGNATURE:
            raise PictureError("this is an encoded stream, not a picture; decode it first")
        damage = png.damage(data) if data[:8] == png.SIGNATURE else ifd.damage(data)
        if damage:
            raise PictureError(damage)
        return embedded.extract(data)


def _open(path: Path) -> ImageInput:
    import OpenImageIO as oiio  # takes 30 ms: not for those who only decode to arrays

    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)
    image = oiio.ImageInput.open(str(path), hints)
    if image is None:
        complaint = _complaint(oiio, path)
        if "could not find a format reader" in complaint:
            complaint = "it is in no picture format that OpenImageIO reads"
        raise PictureError(complaint or "it cannot be opened; the file is damaged or cut off")
    if image.format_name() == "null":
        raise PictureError("it stands for OpenImageIO's null picture")
    return image


def _header(spec: ImageSpec, kind: str) -> Probe:
    """The header in our terms; raises PictureError for pictures that are none of ours."""
    if spec.deep or spec.depth > 1:
        raise PictureError("it is a deep or volume image; only flat pictures can be read")
    if spec.get_int_attribute("tiff:PhotometricInterpretation", -1) in _LAB_PHOTOMETRICS:
        raise PictureError("it is a CIELAB TIFF, which OpenImageIO does not convert; convert it to RGB first")
    formats = {str(sample) for sample in spec.channelformats} or {str(spec.format)}
    if not (len(formats) == 1 or formats <= set(_FLOATS)):
        raise PictureError(f"its channels mix {' and '.join(sorted(formats))} samples; save them as one type")
    native = str(spec.format)
    if native not in ("uint8", "uint16", *_INTEGERS, *_FLOATS):
        raise PictureError(f"its samples are of type {native}; save it with 8, 16 or 32 bits per sample")
    if native == "double" and spec.height == 1:  # OpenImageIO 3.2 leaves such a row unread and says nothing
        raise PictureError("it is a single row of 64-bit floats, which cannot be read; save it as 32-bit floats")
    width, height = spec.width, spec.height
    if is_sideways(_orientation(spec, kind)):
        width, height = height, width
    dtype = np.dtype(native if native in ("uint8", "uint16") else np.float32)
    return Probe(width, height, _layout(spec, kind), spec.nchannels, dtype)


def _layout(spec: ImageSpec, kind: str) -> str:
    alpha = spec.alpha_channel
    match spec.nchannels:
        case 1:
            return "gray"
        case 2 if alpha == 1 or kind in _SECOND_IS_ALPHA:
            return "gray+alpha"
        case 3 if alpha < 0:
            return "rgb"
        case 4 if spec.channelnames[3] == "A":
            return "rgba"
    return "multi"


def _orientation(spec: ImageSpec, kind: str) -> int:
    return 1 if kind in _ALREADY_UPRIGHT else int(spec.get_int_attribute("Orientation", 1))


def _is_associated(spec: ImageSpec, kind: str) -> bool:
    return kind in _ASSOCIATED and spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0


def _pixels(image: ImageInput, spec: ImageSpec, path: Path) -> npt.NDArray[Any]:
    """All samples [H, W, C] in their native type. Any complaint counts: what came with it may be half a
    picture.
    """
    early = _complaint(image, path)
    try:
        pixels = image.read_image(0, 0, 0, spec.nchannels, spec.format)
    except MemoryError:
        raise PictureError("there is not enough memory for its pixels") from None
    complaint = early or _complaint(image, path)
    if pixels is None or complaint:
        raise PictureError(complaint or "its pixels cannot be read; the file is damaged or cut off")
    return np.asarray(pixels).reshape(spec.height, spec.width, spec.nchannels)


def _complaint(speaker: Any, path: Path) -> str:
    """What OpenImageIO has to say, without the path, or an empty text."""
    return first_line(speaker).replace(f'("{path}")', "").replace(str(path), "the file").strip()


def _icc(spec: ImageSpec, channels: str) -> bytes | None:
    """The ICC profile if it is for this layout: one for CMYK is void once the pixels are RGB."""
    profile = spec.get("ICCProfile")
    if profile is None:
        return None
    icc = np.asarray(profile, np.uint8).tobytes()
    space = b"GRAY" if channels.startswith("gray") else b"RGB "
    return icc if channels == "multi" or icc[16:20] == space else None


def _range(pixels: npt.NDArray[Any], channels: str) -> tuple[float, float]:
    """The full range of integers; the lowest and highest colour sample of floats, which must be finite."""
    if pixels.dtype.kind == "u":
        return full_range(pixels.dtype)
    colours = pixels if alpha_index(channels) is None else pixels[..., :-1]
    low, high = float(colours.min()), float(colours.max())
    if not (np.isfinite(low) and np.isfinite(high)):
        raise PictureError("it holds infinite samples; state a sample range to clip them to")
    return low, high if high > low else low + max(1.0, abs(low))
