"""What a file declares of its last channel, and in which order channels stand, where OpenImageIO does not ask."""

from __future__ import annotations

import re
import struct
from typing import Literal, NamedTuple

from sgicodec.errors import PictureError
from sgicodec.metadata import geo, ifd, jp2, jxl, photoshop
from sgicodec.metadata.filebytes import Bytes
from sgicodec.metadata.gdal_items import last_colour

Last = Literal["alpha", "band", "unused"]
"""What the last of two or four channels is: alpha, a band like the others, or bytes without a meaning."""

_EXTRA_SAMPLES, _SAMPLES_PER_PIXEL, _DEPTH = 338, 277, 32997
_BITFIELDS = 3
_BMP_HEADER, _INFO_HEADER, _MIN_WITH_ALPHA = 14, 40, 56
"""Bytes of the file header, and of the oldest information headers that have a compression and a mask of alpha."""
_OPENIMAGEIO_AT = {2: 0, 1: 1, 0: 2, 3: 3}
"""The channel that OpenImageIO makes of each byte of a 32-bit pixel: it takes all for blue, green, red, alpha."""

_CMYK = 12
"""The enumerated colour space of JPEG 2000, whose four channels OpenImageIO takes for red, green, blue and alpha."""
_NO_RGB = (1, 3, 4, 9, 11, 13, 14, 19, 22, 23, 24)
"""Others that no reader converts: luminance and differences, CIELab and the like (ISO/IEC 15444-2, table M.25)."""

_EXTENSION, _NO_ALPHA, _ASSOCIATED = 494, (b"\0", b"\1"), b"\4"
"""Where the extension area of a Targa file says what alpha is, and what it says of none and of bytes to ignore, and of
colours that are multiplied by it.
"""


_PNM = re.compile(rb"P[2356](?:(?:\s|#[^\n]*\n)+(\d+)){3}\s")
"""Its header: width, height and the largest sample, between comments."""
_MAX_PNM_HEADER = 1 << 12


class Channels(NamedTuple):
    """last: what the file says of its last channel, if that may be alpha. order: where red, green, blue and the last
    are among the channels that OpenImageIO gives, None for one after the other. second: whether OpenImageIO loses some,
    or takes them for others, so that another library has to read them; deep: whether it does so with samples that
    are signed or have more than 16 bits. associated: whether colours are multiplied by alpha where OpenImageIO does not
    know; largest: the sample that becomes the largest of its type, where it does not tell, else 0; frames_bits: of a
    sample of an animation of JPEG XL, 0 if not known.
    """

    last: Last = "alpha"
    order: tuple[int, ...] | None = None
    second: bool = False
    deep: bool = False
    associated: bool = False
    largest: int = 0
    frames_bits: int | None = None


AsIs = Channels()


def declared_channels(data: Bytes, kind: str) -> Channels:
    """Those of a file in OpenImageIO's format `kind`. Raises PictureError for those that nobody reads."""
    try:
        if kind == "bmp":
            return _bmp(data)
        if kind == "targa":
            return _targa(data)
        if kind == "jpeg2000" or jp2.is_boxed(data):
            return _jpeg2000(data)
        if kind == "jpegxl":
            return _jpegxl(data)
        if kind == "fits":
            return Channels("band")  # of four planes the last is no alpha, which FITS has not
        if kind == "psd" and photoshop.is_multichannel(data):
            raise PictureError(
                "its channels are inks without a colour space (Multichannel), which are not read; save as RGB"
            )
        if kind == "ico":
            return Channels(second=True)  # OpenImageIO's first icon is the smallest one, as most programs write them
        if kind == "tiff":
            return Channels(_tiff(data))
        if kind == "pnm" and (stated := _PNM.match(bytes(data[:_MAX_PNM_HEADER]))):
            return Channels(largest=int(stated[1]))
    except struct.error:
        pass  # OpenImageIO has the word on damage
    return AsIs


def _jpeg2000(data: Bytes) -> Channels:
    found, space = jp2.components(data), jp2.colour_space(data)
    if space in _NO_RGB:
        raise PictureError(f"its colours are in JPEG 2000's space {space}, which is not converted; save it as RGB")
    is_cmyk = space == _CMYK
    if found is None:
        return Channels(second=is_cmyk)
    last: Last = "alpha" if found.has_opacity or len(found.depths) != 4 else "band"
    return Channels(last, second=is_cmyk, deep=found.is_deep, associated=found.is_associated)


def _jpegxl(data: Bytes) -> Channels:
    """Of channels beside colours OpenImageIO gives one that is alpha alone; it makes up samples for others."""
    found = jxl.image_header(data)
    if found is None:
        return AsIs
    if found.others not in ((), (jxl.ALPHA,)):
        count = len(found.others)
        raise PictureError(
            f"it has {count} channel{'s' * (count > 1)} beside colours, as depth or spot colours, which are not read; "
            "save it as TIFF"
        )
    frames_bits = found.bits if found.is_animation else None
    return Channels(associated=found.is_associated, largest=(1 << found.bits) - 1, frames_bits=frames_bits)


def _tiff(data: Bytes) -> Last:
    """Extra samples are alpha where they are declared at all, unless GDAL calls the last band something else."""
    directory = ifd.entries(data, {_EXTRA_SAMPLES, _SAMPLES_PER_PIXEL, _DEPTH, geo.GDAL_METADATA})
    if _DEPTH in directory and directory[_DEPTH].short > 1:
        raise PictureError(f"it is a volume of {directory[_DEPTH].short} planes; only flat pictures can be read")
    count, text = directory.get(_SAMPLES_PER_PIXEL), directory.get(geo.GDAL_METADATA)
    if _EXTRA_SAMPLES not in directory:
        return "band"
    if count is not None and text is not None:
        colour = last_colour(text.data, count.short)
        return "alpha" if colour in (None, "alpha") else "band"
    return "alpha"


def _bmp(data: Bytes) -> Channels:
    """A BMP of 32 bits has alpha if it has a mask for it: that of BI_RGB (0) is reserved."""
    size, _, _, _, bits, compression = struct.unpack("<IiiHHI", data[_BMP_HEADER : _BMP_HEADER + 20])
    if size < _INFO_HEADER:
        return AsIs
    if bits not in (16, 32) or compression != _BITFIELDS:
        return Channels("unused") if bits == 32 else AsIs
    masks = list(struct.unpack("<4I", data[_BMP_HEADER + 40 : _BMP_HEADER + 56]))
    if size < _MIN_WITH_ALPHA:
        masks[3] = 0
    if bits == 16 and masks[3]:
        raise PictureError("it has alpha in 16-bit pixels, which cannot be read; save it with 32 bits")
    if bits == 16:
        return AsIs
    wanted = masks if masks[3] else masks[:3]
    at = {0xFF << 8 * byte: byte for byte in range(4)}
    if any(mask not in at for mask in wanted):
        raise PictureError("the bit fields of its pixels are not bytes, which cannot be read; save it with 8 bits each")
    order = [_OPENIMAGEIO_AT[at[mask]] for mask in wanted]
    order += [next(channel for channel in range(4) if channel not in order)] if len(order) == 3 else []
    return Channels("alpha" if masks[3] else "unused", None if order == [0, 1, 2, 3] else tuple(order))


def _targa(data: Bytes) -> Channels:
    """A Targa has as many bits of alpha as its descriptor counts, unless its extension area says that there is none."""
    depth, descriptor = struct.unpack("<BB", data[16:18])
    stated = _stated_alpha(data)
    declared = bool(descriptor & 15) and stated not in _NO_ALPHA
    second = depth == 16 and declared and data[2] & 3 == 2  # OpenImageIO drops the one bit of alpha of 5-5-5-1 colour
    return Channels("alpha" if declared else "unused", second=second, associated=stated == _ASSOCIATED)


def _stated_alpha(data: Bytes) -> bytes:
    """What a Targa's extension area says of alpha, if it has one."""
    footer = bytes(data[len(data) - 26 :])
    offset = struct.unpack("<I", footer[:4])[0] if footer[8:24] == b"TRUEVISION-XFILE" else 0
    return bytes(data[offset + _EXTENSION : offset + _EXTENSION + 1]) if offset > 0 else b""
