"""JPEG XL files: EXIF and XMP in their boxes (ISO/IEC 18181-2), also in those that Brotli compressed; whether their
code stream (18181-1 D) is an animation.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

from sgicodec.errors import has_library
from sgicodec.metadata.boxes import boxes
from sgicodec.metadata.filebytes import Bytes

__all__ = ["bits_of_animation", "find", "has_unread", "is_boxed"]

_SIGNATURE = b"\0\0\0\x0cJXL \r\n\x87\n"
_START = b"\xff\x0a"
_SIDES, _SMALL_SIDE, _ORIENTATION, _RATIO = (9, 13, 18, 30), 5, 3, 3
_TIMES = ((0, 0, 10, 30), (0, 0, 8, 10), (0, 3, 16, 32))
"""Bits of fields of the header. Those that have four lengths begin with two bits that say which one."""
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


def bits_of_animation(data: Bytes) -> int | None:
    """Bits of a sample of a file of several frames; 0 where a preview hides whether it is one; None of other files.

    Raises struct.error.
    """
    head = bytes(data[:64])
    if is_boxed(data):
        found = boxes(data, slice(0, len(data)))
        at = next((span.start + 4 * (kind == b"jxlp") for kind, span in found if kind in (b"jxlc", b"jxlp")), 0)
        head = bytes(data[at : at + 64])
    if head[:2] != _START:
        return None
    bits = _Bits(head[2:])
    bits.skip_size()
    if bits.take(1) or not bits.take(1):  # all is as usual, or all that stands before the bits of a sample
        return None
    bits.take(_ORIENTATION)
    if bits.take(1):
        bits.skip_size()
    if bits.take(1):
        return 0
    if not bits.take(1):
        return None
    for lengths in _TIMES:
        bits.take(lengths[bits.take(2)])
    bits.take(1)
    usual = (32, 16, 24) if bits.take(1) else (8, 10, 12)
    which = bits.take(2)
    return usual[which] if which < len(usual) else 1 + bits.take(6)


class _Bits:
    """Bits from the lowest one up; zeros after the end."""

    def __init__(self, data: bytes) -> None:
        self._rest = int.from_bytes(data, "little")

    def take(self, count: int) -> int:
        """The next so many, as a number."""
        value, self._rest = self._rest & ((1 << count) - 1), self._rest >> count
        return value

    def skip_size(self) -> None:
        """Pass over height, ratio and, where that is none, width."""
        is_small = self.take(1)
        self.take(_SMALL_SIDE if is_small else _SIDES[self.take(2)])
        if not self.take(_RATIO):
            self.take(_SMALL_SIDE if is_small else _SIDES[self.take(2)])


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
