"""EXIF and XMP in the boxes of a JPEG XL file (ISO/IEC 18181-2), also in those that Brotli compressed."""

from __future__ import annotations

import struct
from collections.abc import Iterator

from sgicodec.errors import has_library
from sgicodec.metadata.boxes import boxes
from sgicodec.metadata.filebytes import Bytes

__all__ = ["find", "has_unread", "is_boxed"]

_SIGNATURE = b"\0\0\0\x0cJXL \r\n\x87\n"
_EXIF, _XMP, _COMPRESSED = b"Exif", b"xml ", b"brob"
_MAX_UNPACKED = 1 << 24
"""Bytes of a box, which decompression could make of a few."""


def is_boxed(data: Bytes) -> bool:
    """Whether a file begins like one of JPEG XL in boxes; one without has no metadata."""
    return bytes(data[: len(_SIGNATURE)]) == _SIGNATURE


def find(data: Bytes) -> tuple[bytes | None, bytes | None]:
    """The EXIF blob and the XMP packet; of a file that is cut off, those before that."""
    found: dict[bytes, bytes] = {}
    try:
        for kind, contents in _metadata(data):
            if contents is not None:
                found.setdefault(kind, contents)
    except struct.error:
        pass
    exif = found.get(_EXIF, b"")
    return exif[4 + int.from_bytes(exif[:4], "big") :] or None, found.get(_XMP)


def has_unread(data: Bytes) -> bool:
    """Whether there is metadata that cannot be decompressed. Raises struct.error for damage."""
    return any(contents is None for _, contents in _metadata(data))


def _metadata(data: Bytes) -> Iterator[tuple[bytes, bytes | None]]:
    """Kind and contents of each box of it."""
    for kind, span in boxes(data, slice(0, len(data))):
        if kind in (_EXIF, _XMP):
            yield kind, bytes(data[span])
        elif kind == _COMPRESSED and (inner := bytes(data[span.start : span.start + 4])) in (_EXIF, _XMP):
            yield inner, _unpacked(bytes(data[span.start + 4 : span.stop]))


def _unpacked(packed: bytes) -> bytes | None:
    if not has_library("imagecodecs"):
        return None
    import imagecodecs

    try:
        return bytes(imagecodecs.brotli_decode(packed, out=_MAX_UNPACKED))
    except imagecodecs.BrotliError:
        return None
