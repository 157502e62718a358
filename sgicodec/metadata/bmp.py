"""The declaration of alpha in a BMP file: a mask in a header of version 4, without which the fourth byte is unused."""

from __future__ import annotations

import struct
from collections.abc import Iterator

from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.filebytes import Bytes

_FILE_HEADER, _VERSION_3, _VERSION_4 = 14, 40, 108
_BITFIELDS, _MASKS = 3, (0xFF0000, 0xFF00, 0xFF, 0xFF000000)
_SRGB = b"BGRs"
_BLOCK = 1 << 20


def insert(data: Bytes, metadata: Metadata) -> Iterator[bytes]:
    """The file, of 32 bits per pixel and with a header of version 3, with its alpha declared, piece by piece. Files of
    other depths stay as they are; BMP has no place for metadata.
    """
    start = _FILE_HEADER + _VERSION_3
    size, bits = struct.unpack("<I10xH", data[_FILE_HEADER : _FILE_HEADER + 16])
    if size == _VERSION_3 and bits == 32:
        more = _VERSION_4 - _VERSION_3
        yield struct.pack("<2sIHHI", b"BM", len(data) + more, 0, 0, _FILE_HEADER + _VERSION_4)
        yield (
            struct.pack("<I", _VERSION_4)
            + bytes(data[_FILE_HEADER + 4 : _FILE_HEADER + 16])
            + struct.pack("<I", _BITFIELDS)
        )
        yield bytes(data[_FILE_HEADER + 20 : start]) + struct.pack("<4I", *_MASKS) + _SRGB
        yield bytes(more - 20)
    else:
        start = 0
    for at in range(start, len(data), _BLOCK):
        yield bytes(data[at : at + _BLOCK])
