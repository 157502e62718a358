"""EXIF, XMP and `geo` in the boxes of a JPEG 2000 file (ISO/IEC 15444-1 §I.7.2), each under a UUID of its own.

The place is GeoJP2's, a TIFF without pixels. GML, which may state it too, is left to GDAL.
"""

from __future__ import annotations

import struct

from sgicodec.metadata import tiff
from sgicodec.metadata.boxes import boxes
from sgicodec.metadata.filebytes import Bytes

__all__ = ["find", "is_boxed", "states_place"]

_SIGNATURE = b"\0\0\0\x0cjP  \r\n\x87\n"
_GEO = bytes.fromhex("b14bf8bd083d4b43a5ae8cd7d5a6ce03")
_XMP = bytes.fromhex("be7acfcb97a942e89c71999491e3afac")
_EXIF = b"JpgTiffExif->JP2"
_GML = b"gml.data"


def is_boxed(data: Bytes) -> bool:
    """Whether a file begins like one of JPEG 2000 in boxes; one without has no metadata."""
    return bytes(data[: len(_SIGNATURE)]) == _SIGNATURE


def find(data: Bytes) -> tuple[bytes | None, bytes | None, bytes | None]:
    """The EXIF blob, the XMP packet and the `geo` blob; of a file that is cut off, those before that."""
    found = _found(data)
    return found.get(_EXIF), found.get(_XMP), tiff.find(found[_GEO])[2] if _GEO in found else None


def states_place(data: Bytes) -> bool:
    """Whether there is GML, of any file."""
    return is_boxed(data) and _GML in _found(data)


def _found(data: Bytes) -> dict[bytes, bytes]:
    """The first box of each UUID; of a box of GML, that it is there."""
    found: dict[bytes, bytes] = {}
    try:
        for kind, span in boxes(data, slice(0, len(data))):
            if kind == b"uuid":
                found.setdefault(bytes(data[span.start : span.start + 16]), bytes(data[span.start + 16 : span.stop]))
            elif kind == b"asoc" and _GML in bytes(data[span.start : span.start + 32]):
                found[_GML] = b""
    except struct.error:
        pass
    return found
