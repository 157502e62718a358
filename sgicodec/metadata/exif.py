"""EXIF blobs and XMP packets made upright: the picture is turned, so no copy of its orientation may turn it again."""

from __future__ import annotations

import re
import struct

from sgicodec.metadata import ifd, jpeg

__all__ = ["upright", "upright_xmp", "xmp_orientation"]

_SHORT = 3
_ORIENTATION = 274


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
    return re.sub(_IN_XMP + rb"[2-8]", rb"\g<1>1", packet)


def xmp_orientation(packet: bytes) -> int | None:
    """The orientation that an XMP packet states, 1 to 8, or None."""
    found = re.search(_IN_XMP + rb"([1-8])", packet)
    return None if found is None else int(found[2])


_IN_XMP = rb"""(tiff:Orientation\s*(?:=\s*["']|>\s*))"""
