"""Metadata in the chunks of a PNG file, and the check of those chunks (PNG 3, §5.3 and §11.3).

Pillow finds what stands behind the pixels only by decoding them.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator

from sgicodec.metadata import density
from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.density import Density
from sgicodec.metadata.filebytes import Bytes

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_XMP_KEYWORD = b"XML:com.adobe.xmp"
_EXIF_PROFILES = (b"Raw profile type exif", b"Raw profile type APP1")

_OF_IPHONES = (
    "it is a PNG of an iPhone's app (chunk CgBI), which only Apple's programs read; "
    "convert it first, as with pngcrush -revert-iphone-optimizations IN a.png"
)
_TEXT_MAX = 1 << 26
"""Bytes that a compressed text may grow to."""


def damage(data: Bytes) -> str | None:
    """What is wrong with the chunks of a PNG file, or None.

    libpng, called through OpenImageIO, prints its complaints to stderr by itself, and content with a file
    that lacks its end. Looking first finds all that a length or a CRC can tell, quietly.
    """
    kinds: set[bytes] = set()
    at = len(SIGNATURE)
    while b"IEND" not in kinds:
        length, kind = int.from_bytes(data[at : at + 4], "big"), bytes(data[at + 4 : at + 8])
        end = at + 8 + length
        name = kind.decode("ascii", "replace") if kind.isalpha() else "header"
        if end + 4 > len(data):
            return f"the file is cut off in the PNG chunk {name} at byte {at}"
        if _crc(data, at + 4, end) != int.from_bytes(data[end : end + 4], "big"):
            return f"the PNG chunk {name} at byte {at} is damaged, its CRC does not match"
        if kind == b"CgBI":
            return _OF_IPHONES
        kinds.add(kind)
        at = end + 4
    return None if b"IDAT" in kinds else "the PNG file has no pixels, its chunk IDAT is missing"


def find(data: Bytes) -> tuple[bytes | None, bytes | None, bytes | None]:
    """EXIF and XMP, from the chunks made for them or as ImageMagick and ExifTool hid them in texts before; `geo`."""
    exif = xmp = hidden_exif = hidden_xmp = stated = None
    for kind, start, end in chunks(data):
        if kind == b"eXIf":
            exif = bytes(data[start:end])
        elif kind == b"pHYs" and end - start == 9:
            stated = _density(bytes(data[start:end]))
        elif kind in (b"tEXt", b"zTXt", b"iTXt"):
            keyword, text = _text(kind, bytes(data[start:end]))
            if keyword == _XMP_KEYWORD:
                xmp = text
            elif keyword in _EXIF_PROFILES:
                hidden_exif = _raw_profile(text)
            elif keyword == b"Raw profile type xmp":
                hidden_xmp = _raw_profile(text)
    exif = exif or hidden_exif
    return exif, xmp or hidden_xmp, density.tags(stated, exif)


def _density(contents: bytes) -> Density | None:
    """That of a pHYs chunk, whose unit is the metre or none."""
    across, down, unit = struct.unpack(">IIB", contents)
    if not across or not down or unit > 1:
        return None
    return Density((across, 100), (down, 100), 3) if unit else Density((across, 1), (down, 1), 1)


def density_field(found: Density) -> bytes | None:
    """A density as pHYs states it, in whole pixels per metre, within a hundredth; None where it cannot."""
    if found.unit == 1:
        pair = [ratio[0] * other[1] for ratio, other in ((found.across, found.down), (found.down, found.across))]
    else:
        pair = [round(100 * value) for value in found.per(3)]
        if any(abs(n - 100 * value) > value for n, value in zip(pair, found.per(3), strict=True)):
            return None
    return struct.pack(">IIB", *pair, found.unit != 1) if all(0 < value < 1 << 31 for value in pair) else None


def metadata_chunks(metadata: Metadata) -> bytes:
    """The chunks between IHDR and the pixels: ICC profile, density, EXIF and XMP, as far as there are any."""
    made = b""
    if metadata.icc is not None:
        made += chunk(b"iCCP", b"ICC profile\0\0" + zlib.compress(metadata.icc))
    found = density.density(metadata.geo, metadata.exif)
    if found is not None and (physical := density_field(found)):
        made += chunk(b"pHYs", physical)
    if metadata.exif is not None:
        made += chunk(b"eXIf", metadata.exif)
    if metadata.xmp is not None:
        made += chunk(b"iTXt", _XMP_KEYWORD + bytes(5) + metadata.xmp)
    return made


def chunks(data: Bytes) -> Iterator[tuple[bytes, int, int]]:
    """Kind, start and end of the contents of each whole chunk, up to IEND: nothing behind it is of the picture."""
    at, kind = len(SIGNATURE), b""
    while at + 12 <= len(data) and kind != b"IEND":
        kind, end = bytes(data[at + 4 : at + 8]), at + 8 + int.from_bytes(data[at : at + 4], "big")
        if end + 4 > len(data):
            return
        yield kind, at + 8, end
        at = end + 4


def _crc(data: Bytes, start: int, end: int, step: int = 1 << 20) -> int:
    crc = 0
    for at in range(start, end, step):
        crc = zlib.crc32(data[at : min(at + step, end)], crc)
    return crc


def _text(kind: bytes, contents: bytes) -> tuple[bytes, bytes]:
    """Keyword and text of a tEXt, zTXt or iTXt chunk; an empty text if it cannot be unpacked."""
    keyword, _, text = contents.partition(b"\0")
    packed = kind == b"zTXt" or (kind == b"iTXt" and text[:1] == b"\1")
    if kind == b"zTXt":
        text = text[1:]
    elif kind == b"iTXt":
        text = text[2:].split(b"\0", 2)[-1]
    try:
        return keyword, zlib.decompressobj().decompress(text, _TEXT_MAX) if packed else text
    except zlib.error:
        return keyword, b""


def _raw_profile(text: bytes) -> bytes | None:
    """A blob spelt as a line with its name, one with its length, and lines of hexadecimal digits."""
    try:
        return bytes.fromhex(text.split(b"\n", 3)[3].decode("ascii"))
    except (IndexError, ValueError):
        return None


def chunk(kind: bytes, contents: bytes) -> bytes:
    """A whole chunk: length, kind, contents and their CRC."""
    crc = zlib.crc32(contents, zlib.crc32(kind))
    return struct.pack(">I", len(contents)) + kind + contents + struct.pack(">I", crc)


def frames(data: Bytes) -> int:
    """How many pictures an animated PNG shows, its still one included; 1 of others."""
    count, still = 0, 1
    for kind, start, _ in chunks(data):
        if kind == b"acTL":
            count = int.from_bytes(data[start : start + 4], "big")
        elif kind == b"fcTL":
            still = 0
        elif kind == b"IDAT":
            break
    return max(1, count + still) if count else 1
