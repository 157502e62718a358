"""EXIF and XMP in the marker segments of a JPEG file (EXIF 3.0 §4.7, XMP part 3 §1.1.3)."""

from __future__ import annotations

import itertools
import struct
from collections.abc import Iterator

from sgicodec.errors import PictureError
from sgicodec.metadata.filebytes import Bytes

__all__ = ["EXIF_PREFIX", "SIGNATURE", "find", "insert"]

SIGNATURE = b"\xff\xd8\xff"
EXIF_PREFIX = b"Exif\0\0"
_XMP_PREFIX = b"http://ns.adobe.com/xap/1.0/\0"
_START_OF_SCAN, _APP0, _APP1 = 0xDA, 0xE0, 0xE1
_PAYLOAD_MAX = 65533
_PIECE = 1 << 20


def find(data: Bytes) -> tuple[bytes | None, bytes | None]:
    """The first EXIF blob and the first XMP packet; an extended packet's continuation is left behind."""
    exif = xmp = None
    for start, end in _segments(data):
        payload = bytes(data[start + 4 : end]) if data[start + 1] == _APP1 else b""
        if payload.startswith(EXIF_PREFIX) and exif is None:
            exif = payload
        elif payload.startswith(_XMP_PREFIX) and xmp is None:
            xmp = payload.removeprefix(_XMP_PREFIX)
    return exif, xmp


def insert(data: Bytes, exif: bytes | None, xmp: bytes | None) -> Iterator[bytes]:
    """The file with this metadata in place of any that it has, piece by piece. Raises PictureError if it does not fit
    a segment.
    """
    segments = [bytes(data[start:end]) for start, end in _segments(data)]
    rest = range(2 + sum(map(len, segments)), len(data), _PIECE)
    kept = [segment for segment in segments if not segment.startswith((EXIF_PREFIX, _XMP_PREFIX), 4)]
    jfif = list(itertools.takewhile(lambda segment: segment[1] == _APP0, kept))
    ours = [_segment(EXIF_PREFIX, exif, "EXIF"), _segment(_XMP_PREFIX, xmp, "XMP")]
    yield from (bytes(data[:2]), *jfif, *ours, *kept[len(jfif) :])
    yield from (bytes(data[start : start + _PIECE]) for start in rest)


def _segments(data: Bytes) -> Iterator[tuple[int, int]]:
    """Start and end of each marker segment before the first scan."""
    at = 2
    while at + 4 <= len(data) and data[at] == 0xFF and data[at + 1] not in (0xFF, _START_OF_SCAN):
        end = at + 2 + int.from_bytes(data[at + 2 : at + 4], "big")
        if end > len(data):
            return
        yield at, end
        at = end


def _segment(prefix: bytes, payload: bytes | None, name: str) -> bytes:
    if payload is None:
        return b""
    size = len(prefix) + len(payload)
    if size > _PAYLOAD_MAX:
        most = _PAYLOAD_MAX - len(prefix)
        raise PictureError(f"jpeg cannot hold {len(payload)} bytes of {name}, only {most}; choose another format")
    return struct.pack(">BBH", 0xFF, _APP1, size + 2) + prefix + payload
