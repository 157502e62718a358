"""ICC profiles (ICC.1:2022): whether one is for the samples beside it, and those that OpenImageIO does not find."""

from __future__ import annotations

import struct
import zlib

from sgicodec.metadata import jpeg, png
from sgicodec.metadata.filebytes import Bytes

_HEADER, _ROW, _MOST = 128, 12, 1 << 26
_JPEG_PREFIX = b"ICC_PROFILE\0"
_BMP_HEADER, _BMP_VERSION_5, _BMP_EMBEDDED = 14, 124, b"DEBM"


def fitting(profile: bytes | None, channels: str) -> tuple[bytes | None, str | None]:
    """The profile if it is sound and for this layout, else what is said of it. That of inks is void beside RGB."""
    if profile is None:
        return None, None
    if not _is_sound(profile):
        return None, "ICC profile (damaged)"
    space = b"GRAY" if channels.startswith("gray") else b"RGB "
    if channels == "multi" or profile[16:20] == space:
        return profile, None
    return None, "ICC profile (of another colour space)"


def _is_sound(profile: bytes) -> bool:
    """Whether all of its tags are there."""
    if len(profile) < _HEADER + 4 or profile[36:40] != b"acsp":
        return False
    count = int.from_bytes(profile[_HEADER : _HEADER + 4], "big")
    rows = profile[_HEADER + 4 : _HEADER + 4 + _ROW * count]
    return len(rows) == _ROW * count and all(
        start + length <= len(profile) for _, start, length in struct.iter_unpack(">III", rows)
    )


def stated(data: Bytes) -> bytes | None:
    """The profile in a JPEG, PNG or BMP file. OpenImageIO does not find BMP's, libpng no damaged one."""
    if data[:3] == jpeg.SIGNATURE:
        payloads = (bytes(data[start + 4 : end]) for start, end in jpeg.segments(data) if data[start + 1] == 0xE2)
        pieces = [payload[len(_JPEG_PREFIX) :] for payload in payloads if payload.startswith(_JPEG_PREFIX)]
        return b"".join(piece[2:] for piece in sorted(pieces)) or None
    if data[:8] == png.SIGNATURE:
        found = next((span for kind, *span in png.chunks(data) if kind in (b"iCCP", b"IDAT")), None)
        return None if found is None or bytes(data[found[0] - 4 : found[0]]) != b"iCCP" else _unpacked(data, *found)
    return _of_bmp(data) if data[:2] == b"BM" else None


def _unpacked(data: Bytes, start: int, end: int) -> bytes:
    """That of a chunk iCCP; as far as it can be unpacked."""
    try:
        return zlib.decompressobj().decompress(bytes(data[start:end]).partition(b"\0")[2][1:], _MOST)
    except zlib.error:
        return b""


def _of_bmp(data: Bytes) -> bytes | None:
    header = bytes(data[_BMP_HEADER : _BMP_HEADER + _BMP_VERSION_5])
    is_version_5 = len(header) == _BMP_VERSION_5 and header[:4] == struct.pack("<I", _BMP_VERSION_5)
    if not is_version_5 or header[56:60] != _BMP_EMBEDDED:
        return None
    offset, length = struct.unpack("<II", header[112:120])
    return bytes(data[_BMP_HEADER + offset : _BMP_HEADER + offset + length])
