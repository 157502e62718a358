"""EXIF, XMP and density in the marker segments of a JPEG file (T.81 B.1; EXIF 3.0 §4.7; XMP part 3 §1.1.3; JFIF 1.02).

Pillow finds EXIF as well, but of several XMP segments it keeps the last one, and no extended packet.
"""

from __future__ import annotations

import itertools
import re
import struct
from collections.abc import Iterator

from sgicodec.errors import PictureError
from sgicodec.metadata import density, exif, extended_xmp
from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.density import Density
from sgicodec.metadata.filebytes import Bytes

SIGNATURE = b"\xff\xd8\xff"
_JFIF = b"JFIF\0"
XMP_PREFIX = b"http://ns.adobe.com/xap/1.0/\0"
EXTENSION_PREFIX = b"http://ns.adobe.com/xmp/extension/\0"
_PREFIXES = (b"Exif\0", XMP_PREFIX, EXTENSION_PREFIX)
_SCAN, _END, _APP0, _APP1 = 0xDA, 0xD9, 0xE0, 0xE1
_ALONE = (0x01, *range(0xD0, 0xD9))
"""Markers without a segment."""

_MARKER = re.compile(rb"\xff[^\0\xff]")

_SCAN_END = re.compile(rb"\xff[\xc0-\xcf\xd9-\xfe]")
"""A marker that ends coded samples, as those of restarts do not."""

_PAYLOAD_MAX = 65533
_PIECE = 1 << 20
_TIFF_HEADS = (b"II*\0", b"MM\0*")
_UNITS = (1, 2, 3)
"""Those of TIFF for none, inch and centimetre, which are 0, 1 and 2 in JFIF."""


def find(data: Bytes) -> tuple[bytes | None, bytes | None, bytes | None]:
    """The first EXIF blob, with what further segments continue; the first XMP packet, with its extension; `geo`."""
    xmp = stated = None
    parts: list[bytes] = []
    extensions = []
    for start, end in segments(data):
        marker, payload = data[start + 1], b""
        if marker in (_APP0, _APP1):
            payload = bytes(data[start + 4 : end])
        if marker == _APP0 and payload.startswith(_JFIF) and stated is None:
            stated = _density(payload)
        elif payload.startswith(XMP_PREFIX) and xmp is None:
            xmp = payload.removeprefix(XMP_PREFIX)
        elif payload.startswith(EXTENSION_PREFIX):
            extensions.append(payload.removeprefix(EXTENSION_PREFIX))
        elif marker == _APP1 and payload.startswith(b"Exif\0"):
            part = payload[len(exif.PREFIX) :]
            if bool(parts) != part.startswith(_TIFF_HEADS):
                parts.append(part)
    blob = b"".join(parts) or None
    xmp = xmp if xmp is None else extended_xmp.joined(xmp, extensions)
    return blob, xmp, density.tags(stated, blob)


def insert(data: Bytes, metadata: Metadata) -> Iterator[bytes]:
    """The file with this metadata in place of its own, piece by piece. Raises PictureError if it does not fit
    a segment.
    """
    spans = list(segments(data))
    found = [bytes(data[start:end]) for start, end in spans]
    rest = range(spans[-1][1], len(data), _PIECE)
    kept = [segment for segment in found if not segment.startswith(_PREFIXES, 4)]
    jfif = list(itertools.takewhile(lambda segment: segment[1] == _APP0, kept))
    dense = density.density(metadata.geo, metadata.exif)
    ours = [] if metadata.exif is None else [_segment(exif.PREFIX, metadata.exif, "EXIF")]
    if metadata.xmp is not None:
        is_long = len(metadata.xmp) > _PAYLOAD_MAX - len(XMP_PREFIX)
        packet = extended_xmp.without_padding(metadata.xmp) if is_long else metadata.xmp
        ours.append(_segment(XMP_PREFIX, packet, "XMP"))
    yield from (bytes(data[:2]), *(_with_density(segment, dense) for segment in jfif), *ours, *kept[len(jfif) :])
    yield from (bytes(data[start : start + _PIECE]) for start in rest)


def segments(data: Bytes) -> Iterator[tuple[int, int]]:
    """Start and end of each marker segment before the first scan. Fill bytes before markers, and anything else there,
    are passed over, as decoders do.
    """
    at = _marker(data, 2)
    while at + 4 <= len(data) and data[at + 1] not in (_SCAN, _END):
        length = 0 if data[at + 1] in _ALONE else int.from_bytes(data[at + 2 : at + 4], "big")
        end = at + 2 + length
        if end > len(data):
            return
        if length:
            yield at, end
        at = _marker(data, end)


def end(data: Bytes) -> int:
    """Place behind the picture's end marker; the end of the file if it has none."""
    at = max((stop for _, stop in segments(data)), default=2)
    while at < len(data):
        found = _SCAN_END.search(piece := bytes(data[at : at + _PIECE]))
        if found is None:
            at += max(1, len(piece) - 1)
        elif found[0][1] == _END:
            return at + found.end()
        else:
            start = at + found.end()
            at = start + int.from_bytes(data[start : start + 2], "big")
    return len(data)


def _marker(data: Bytes, at: int) -> int:
    """Place of the last 0xFF before the next marker, from `at` on; the end if there is none."""
    if _MARKER.match(bytes(data[at : at + 2])):
        return at
    for start in range(at, len(data), _PIECE):
        found = _MARKER.search(bytes(data[start : start + _PIECE + 1]))
        if found is not None:
            return start + found.start()
    return len(data)


def _density(payload: bytes) -> Density | None:
    """That of a JFIF segment."""
    if len(payload) < 12 or payload[7] >= len(_UNITS):
        return None
    across, down = struct.unpack_from(">HH", payload, 8)
    return Density((across, 1), (down, 1), _UNITS[payload[7]]) if across and down else None


def _with_density(segment: bytes, found: Density | None) -> bytes:
    """A JFIF segment with this density; as it is if it does not hold it."""
    stated = None if found is None else density_field(found)
    return segment if stated is None or not segment.startswith(_JFIF, 4) else segment[:11] + stated + segment[16:]


def density_field(found: Density) -> bytes | None:
    """A density as JFIF states it, in whole pixels: exactly per its own unit, or within a hundredth per inch; None if
    neither can be.
    """
    for unit, tolerance in ((found.unit, 0.0), (min(found.unit, 2), 0.01)):
        pair = found.per(unit)
        whole = [round(value) for value in pair]
        if all(0 < n <= 0xFFFF and abs(n / value - 1) <= tolerance for n, value in zip(whole, pair, strict=True)):
            return struct.pack(">BHH", _UNITS.index(unit), *whole)
    return None


def _segment(prefix: bytes, payload: bytes, name: str) -> bytes:
    size = len(prefix) + len(payload)
    if size > _PAYLOAD_MAX:
        most = _PAYLOAD_MAX - len(prefix)
        raise PictureError(
            f"jpeg cannot hold {len(payload)} bytes of {name}, only {most}; choose another format, or leave metadata "
            "out (--no-metadata)"
        )
    return struct.pack(">BBH", 0xFF, _APP1, size + 2) + prefix + payload
