"""EXIF and XMP in the RIFF chunks of a WebP file (RFC 9649 §2.7)."""

from __future__ import annotations

import struct
from collections.abc import Iterator

from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.filebytes import Bytes

_HAS_ALPHA, _HAS_EXIF, _HAS_XMP, _IS_ANIMATED = 0x10, 0x08, 0x04, 0x02


def is_webp(data: Bytes) -> bool:
    """Whether the file begins like a WebP file."""
    return data[:4] == b"RIFF" and data[8:12] == b"WEBP"


def is_animated(head: bytes) -> bool:
    """Whether a file that begins so is a WebP of frames."""
    return is_webp(head) and head[12:16] == b"VP8X" and len(head) > 20 and bool(head[20] & _IS_ANIMATED)


def find(data: Bytes) -> tuple[bytes | None, bytes | None]:
    """The EXIF blob and the XMP packet."""
    found = {kind: bytes(data[start:end]) for kind, start, end in chunks(data) if kind in (b"EXIF", b"XMP ")}
    return found.get(b"EXIF"), found.get(b"XMP ")


def insert(data: Bytes, metadata: Metadata) -> Iterator[bytes]:
    """The losslessly compressed file, which has no metadata yet, with this EXIF and XMP, piece by piece."""
    exif, xmp = metadata.exif, metadata.xmp
    parts = [(kind, bytes(data[start:end])) for kind, start, end in chunks(data)]
    if parts[0][0] != b"VP8X":
        parts.insert(0, (b"VP8X", _extended_header(parts[0][1])))
    flags = (_HAS_EXIF if exif is not None else 0) | (_HAS_XMP if xmp is not None else 0)
    parts[0] = (b"VP8X", bytes([parts[0][1][0] | flags]) + parts[0][1][1:])
    parts += [(kind, blob) for kind, blob in ((b"EXIF", exif), (b"XMP ", xmp)) if blob is not None]
    body = b"".join(kind + struct.pack("<I", len(part)) + part + bytes(len(part) % 2) for kind, part in parts)
    yield b"RIFF" + struct.pack("<I", 4 + len(body)) + b"WEBP"
    yield body


def _extended_header(vp8l: bytes) -> bytes:
    """The VP8X contents for a lossless picture: flags, three bytes of zero, width - 1 and height - 1 in 24
    bits.
    """
    bits = int.from_bytes(vp8l[1:5], "little")
    width, height, alpha = bits & 0x3FFF, bits >> 14 & 0x3FFF, bits >> 28 & 1
    return struct.pack("<I", alpha * _HAS_ALPHA) + width.to_bytes(3, "little") + height.to_bytes(3, "little")


def chunks(data: Bytes) -> Iterator[tuple[bytes, int, int]]:
    """Kind, start and end of the contents of each whole chunk."""
    at = 12
    while at + 8 <= len(data):
        start, length = at + 8, int.from_bytes(data[at + 4 : at + 8], "little")
        if start + length > len(data):
            return
        yield bytes(data[at : at + 4]), start, start + length
        at = start + length + length % 2
