"""EXIF blobs: taken from anywhere, made upright, moved in and out of TIFF files.

JPEG, PNG and WebP carry EXIF as one blob, a small TIFF of its own. A TIFF file has the same tags scattered
over its own directory, where they stand among those that describe the pixels.
"""

from __future__ import annotations

import mmap
import re
import struct
from pathlib import Path

from . import ifd, jpeg

__all__ = ["from_tiff", "into_tiff", "upright", "upright_xmp"]

_BYTE, _SHORT = 1, 3
_ORIENTATION, _DATETIME, _XMP = 274, 306, 700

_RESOLUTION = {282, 283, 296}
_DESCRIPTIVE = {269, 270, 271, 272, 305, _DATETIME, 315, 316, 18246, 33432, *range(40091, 40096)}
"""Document name, description, make, model, software, date, artist, host, rating, copyright, Windows' tags."""

_CARRIED = _DESCRIPTIVE | _RESOLUTION | {ifd.EXIF_IFD, ifd.GPS_IFD}


def upright(blob: bytes) -> bytes | None:
    """The blob without its JPEG prefix and with its orientation set to 1.

    None if it holds nothing else or is no TIFF structure.

    The value is changed where it stands: maker notes hold offsets that would not survive a rewrite.
    """
    blob = blob.removeprefix(jpeg.EXIF_PREFIX)
    spelling = ifd.layout(blob)
    if spelling is None or spelling.big:
        return None
    changed = bytearray(blob)
    try:
        rows = ifd.rows(blob, ifd.first_directory(blob, spelling), spelling)
    except struct.error:
        return None
    for row in rows:
        if row.tag == _ORIENTATION:
            struct.pack_into(spelling.order + "HIHH", changed, row.at - 6, _SHORT, 1, 1, 0)
    return bytes(changed) if any(row.tag != _ORIENTATION for row in rows) else None


def upright_xmp(packet: bytes) -> bytes:
    """The XMP packet with its copy of the orientation, which some readers obey, set to 1."""
    return re.sub(rb"""(tiff:Orientation\s*(?:=\s*["']|>\s*))[2-8]""", rb"\g<1>1", packet)


def from_tiff(data: ifd.Bytes) -> tuple[bytes | None, bytes | None]:
    """EXIF and XMP of a TIFF file; a directory with nothing but a resolution is no EXIF."""
    try:
        directory = ifd.load(data)
    except struct.error:
        return None, None
    xmp = directory.get(_XMP)
    carried = {tag: item for tag, item in directory.items() if tag in _CARRIED}
    exif = b"II*\0\x08\0\0\0" + ifd.dump(carried, 8) if carried.keys() - _RESOLUTION else None
    return exif, xmp.data if isinstance(xmp, ifd.Entry) else None


def into_tiff(path: Path, exif: bytes | None, xmp: bytes | None) -> None:
    """Give the little-endian TIFF file at `path` the tags of an EXIF blob and an XMP packet.

    A new first directory is appended and the header made to point at it. The time of writing, which a library
    may have stamped, gives way to the blob's date or to none, so that equal pictures make equal files.
    """
    with path.open("r+b") as file:
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            spelling = ifd.layout(data)
            directory = ifd.load(data)
            end = len(data) + len(data) % 2
        if spelling is None or spelling.order != "<":
            raise struct.error("not a little-endian TIFF")
        directory.pop(_DATETIME, None)
        if exif is not None:
            directory |= {tag: item for tag, item in ifd.load(exif).items() if tag in _CARRIED}
        if xmp is not None:
            directory[_XMP] = ifd.Entry(_BYTE, xmp)
        file.seek(end)
        file.write(ifd.dump(directory, end, big=spelling.big))
        file.seek(spelling.first)
        file.write(spelling.place.pack(end))
