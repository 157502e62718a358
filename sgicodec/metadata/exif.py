"""EXIF blobs and XMP packets that follow their picture: turned upright, so that no copy of its orientation turns it
again, and in another scale.
"""

from __future__ import annotations

import re
import struct

from sgicodec.metadata import ifd, jpeg

__all__ = ["rescaled", "scaled_ratio", "upright", "upright_xmp", "xmp_orientation"]

_SHORT, _RATIONAL = 3, 5
_ORIENTATION, _X_RESOLUTION, _Y_RESOLUTION = 274, 282, 283


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


def rescaled(blob: bytes, across: float, down: float) -> bytes:
    """The EXIF blob of a picture that has so many times the pixels across and down: the pixels per unit that it states
    are changed where they stand.
    """
    spelling = ifd.layout(blob)
    if spelling is None or spelling.big:
        return blob
    changed, pair = bytearray(blob), struct.Struct(spelling.order + "II")
    factors = {_X_RESOLUTION: across, _Y_RESOLUTION: down}
    try:
        for row in ifd.rows(blob, ifd.first_directory(blob, spelling), spelling):
            if row.tag in factors and row.kind == _RATIONAL and row.values == 1:
                (at,) = spelling.place.unpack_from(blob, row.at)
                above, below = pair.unpack_from(blob, at)
                pair.pack_into(changed, at, *scaled_ratio(above, below, factors[row.tag]))
    except struct.error:
        return blob
    return bytes(changed)


def scaled_ratio(numerator: int, denominator: int, factor: float) -> tuple[int, int]:
    """A fraction of 32-bit numbers times a factor; one without a value stays so."""
    from fractions import Fraction  # takes long to load

    if denominator == 0:
        return numerator, denominator
    scaled = (Fraction(numerator, denominator) * Fraction(factor)).limit_denominator(1 << 16)
    return min(scaled.numerator, (1 << 32) - 1), scaled.denominator


def upright_xmp(packet: bytes) -> bytes:
    """The XMP packet with its copy of the orientation, which some readers obey, set to 1."""
    return re.sub(_IN_XMP + rb"[2-8]", rb"\g<1>1", packet)


def xmp_orientation(packet: bytes) -> int | None:
    """The orientation that an XMP packet states, 1 to 8, or None."""
    found = re.search(_IN_XMP + rb"([1-8])", packet)
    return None if found is None else int(found[2])


_IN_XMP = rb"""(tiff:Orientation\s*(?:=\s*["']|>\s*))"""
