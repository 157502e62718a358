"""What the header of a picture file says, in our terms, or why the picture is none of ours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sgicodec.errors import PictureError
from sgicodec.image.channels import Last
from sgicodec.metadata.layouts import WITHOUT_ALPHA, alpha_index
from sgicodec.metadata.orientation import is_sideways

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

MAX_SAMPLES = 1 << 31
"""Default cap on width × height × channels of what is held in memory at once."""

_WHITE_IS_ZERO, _GRAY, _RGB, _PALETTE, _YCBCR = 0, 1, 2, 3, 6
_LAB_PHOTOMETRICS = (8, 9, 10)
_FLOATS = ("half", "float", "double")
_INTEGERS = ("int8", "int16", "int", "uint")
_UINT16_ZERO = 1 << 15

_ASSOCIATED = ("openexr", "tiff")
"""Formats that store premultiplied alpha unless OpenImageIO says that this file does not."""

_SECOND_IS_ALPHA = ("jpegxl", "sgi", "targa")
"""Formats whose second of two channels is alpha although OpenImageIO does not name it so."""

ALREADY_UPRIGHT = ("jpegxl",)
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


def header(spec: ImageSpec, kind: str, last: Last = "alpha") -> Probe:
    """The header of a file in the format `kind`, whose last channel is `last` if OpenImageIO takes it for alpha.

    Raises PictureError for what cannot be read faithfully.
    """
    if min(spec.width, spec.height, spec.nchannels) < 1:
        raise PictureError("it holds no pixels")
    if spec.deep or spec.depth > 1:
        raise PictureError("it is a deep or volume image; only flat pictures can be read")
    if _photometric(spec) in _LAB_PHOTOMETRICS:
        raise PictureError("it is a CIELAB TIFF, which OpenImageIO does not convert; convert it to RGB first")
    if {"RY", "BY"} <= set(spec.channelnames):
        raise PictureError(
            "its colours are luminance and differences (Y, RY, BY), which are not converted; save it as RGB"
        )
    formats = {str(sample) for sample in spec.channelformats} or {str(spec.format)}
    if not (len(formats) == 1 or formats <= set(_FLOATS)):
        raise PictureError(f"its channels mix {' and '.join(sorted(formats))} samples; save them as one type")
    native = "uint16" if holds_shifted_uint16(spec, kind) else str(spec.format)
    if native not in ("uint8", "uint16", *_INTEGERS, *_FLOATS):
        raise PictureError(f"its samples are of type {native}; save it with 8, 16 or 32 bits per sample")
    if is_white_zero(spec) and native not in ("uint8", "uint16"):
        raise PictureError(f"0 is white in its {native} samples, which cannot be read; invert it first")
    width, height = spec.width, spec.height
    if is_sideways(orientation(spec, kind)):
        width, height = height, width
    dtype = np.dtype(native if native in ("uint8", "uint16") else np.float32)
    channels, count = _layout(spec, kind), spec.nchannels
    if last != "alpha" and alpha_index(channels) is not None:
        channels, count = ("multi", count) if last == "band" else (WITHOUT_ALPHA[channels], count - 1)
    return Probe(width, height, channels, count, dtype)


def _layout(spec: ImageSpec, kind: str) -> str:
    alpha = spec.alpha_channel
    match spec.nchannels:
        case 1:
            return "gray"
        case 2 if alpha == 1 or kind in _SECOND_IS_ALPHA:
            return "gray+alpha"
        case 3 if alpha < 0 and _photometric(spec) != _GRAY:  # a TIFF of three bands that are no colours
            return "rgb"
        case 4 if spec.channelnames[3] == "A":
            return "rgba"
    return "multi"


def holds_shifted_uint16(spec: ImageSpec, kind: str) -> bool:
    """Whether a FITS file holds unsigned integers of 16 bits as signed ones, less 32768 (FITS 4.0, 5.2.5).

    Raises PictureError for other scales and offsets, which OpenImageIO does not apply.
    """
    zero, scale = (spec.get_float_attribute(name, usual) for name, usual in (("Bzero", 0), ("Bscale", 1)))
    if kind != "fits" or (zero, scale) == (0, 1):
        return False
    if (zero, scale) != (_UINT16_ZERO, 1) or str(spec.format) != "int16":
        values = f"BSCALE {scale:.7g} and BZERO {zero:.7g}"
        raise PictureError(f"{values} of its samples are not applied; save the numbers that they stand for as floats")
    return True


def orientation(spec: ImageSpec, kind: str) -> int:
    """How the stored pixels must be turned, 1 to 8."""
    return 1 if kind in ALREADY_UPRIGHT else int(spec.get_int_attribute("Orientation", 1))


def is_associated(spec: ImageSpec, kind: str) -> bool:
    """Whether the colours, if there is alpha, come multiplied by it."""
    return kind in _ASSOCIATED and spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0


def _photometric(spec: ImageSpec) -> int:
    return int(spec.get_int_attribute("tiff:PhotometricInterpretation", -1))


def band_colours(spec: ImageSpec, with_alpha: bool) -> list[str]:
    """GDAL's names of what the bands of a TIFF show, empty for those that are undefined."""
    names = ["Red", "Green", "Blue"] if _photometric(spec) == _RGB else []
    names += [""] * (spec.nchannels - len(names))
    if with_alpha and spec.alpha_channel >= 0:
        names[spec.alpha_channel] = "Alpha"
    return names


def is_white_zero(spec: ImageSpec) -> bool:
    """Whether 0 is white in the first channel of a TIFF. OpenImageIO has turned over 8 bits, in all channels."""
    return _photometric(spec) == _WHITE_IS_ZERO


def has_own_numbers(spec: ImageSpec) -> bool:
    """Whether the samples of a TIFF come as the numbers that stand in the file: not stretched to more bits, not turned
    over, no indices of a palette.
    """
    bits = spec.get_int_attribute("oiio:BitsPerSample", 0)
    stretched = str(spec.format) in ("uint8", "uint16") and bits not in (0, 8 * spec.format.size())
    return not stretched and _photometric(spec) in (_GRAY, _RGB, _YCBCR)


def bits_shifted(spec: ImageSpec, kind: str) -> int:
    """By how many bits OpenImageIO has shifted the integers of a TIFF, as those of 24 bits, which then fill 32."""
    bits = spec.get_int_attribute("oiio:BitsPerSample", 0)
    return 32 - bits if (kind, str(spec.format)) == ("tiff", "uint") and 0 < bits < 32 else 0


def renumbered(spec: ImageSpec, kind: str, stated: int = 0) -> str:
    """What numbers samples come as, in words, where they have few bits or 0 is white; empty if these are their own.
    Less than 8 bits are levels of a screen in other formats than TIFF, whose numbers mean nothing. stated: the largest
    sample, if OpenImageIO does not tell its bits.
    """
    bits = int(spec.get_int_attribute("oiio:BitsPerSample", 0)) or stated.bit_length()
    full = 8 * spec.format.size()
    if str(spec.format) not in ("uint8", "uint16") or not 0 < bits <= full or _photometric(spec) == _PALETTE:
        return ""
    largest, top = (1 << full) - 1, stated or (1 << bits) - 1
    if (full == 8 and kind != "tiff") or (top == largest and not is_white_zero(spec)):
        return ""
    times, rest = divmod(largest, top)
    rounded = "rounded" if kind in ("jpeg2000", "jpegxl") else "rounded down"
    factor = f" · {largest} / {top} {rounded}" if rest else f" · {times}" if times > 1 else ""
    white = f"{largest} − " if is_white_zero(spec) else ""
    few = f"of its {bits} bit{'s' * (bits > 1)} become {full} bits," if top < largest else "become"
    return f"samples v {few} {white}v{factor}"


def number_as_read(value: float, spec: ImageSpec) -> float | None:
    """What OpenImageIO makes of the sample `value` of a TIFF that has not its own numbers; None if nothing certain."""
    bits = spec.get_int_attribute("oiio:BitsPerSample", 0)
    photometric, native = _photometric(spec), str(spec.format)
    if photometric not in (_WHITE_IS_ZERO, _GRAY, _RGB) or native not in ("uint8", "uint16") or not 1 <= bits <= 16:
        return None
    most, largest = (1 << bits) - 1, (1 << 8 * spec.format.size()) - 1
    if not (0 <= value <= most and value == int(value)):
        return None
    read = int(value) * largest // most
    return float(largest - read if photometric == _WHITE_IS_ZERO else read)
