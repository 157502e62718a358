"""JPEG XL files: EXIF and XMP in their boxes (ISO/IEC 18181-2), also in those that Brotli compressed; what their code
stream (18181-1 D) says of samples and channels, and whether it is an animation.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import NamedTuple

from sgicodec.errors import has_library
from sgicodec.metadata.boxes import boxes
from sgicodec.metadata.filebytes import Bytes

_SIGNATURE = b"\0\0\0\x0cJXL \r\n\x87\n"
_START = b"\xff\x0a"
_SIDES, _SMALL_SIDE, _ORIENTATION, _RATIO = (9, 13, 18, 30), 5, 3, 3
_TIMES = ((0, 0, 10, 30), (0, 0, 8, 10), (0, 3, 16, 32))
"""Bits of fields of the header. Those that have four lengths begin with two bits that say which one."""
_BITS, _FLOAT_BITS = ((8, 0), (10, 0), (12, 0), (1, 6)), ((32, 0), (16, 0), (24, 0), (1, 6))
_COUNT, _KIND = ((0, 0), (1, 0), (2, 4), (1, 12)), ((0, 0), (1, 0), (2, 4), (18, 6))
_SHIFT, _NAME, _CFA_CHANNEL = (
    ((0, 0), (3, 0), (4, 0), (1, 3)),
    ((0, 0), (0, 4), (16, 5), (48, 10)),
    ((1, 0), (0, 2), (3, 4), (19, 8)),
)
"""The same of numbers: the least, and the bits that add to it."""
_EXPONENT, _INK = 4, 4 * 16
ALPHA, _SPOT, _CFA = 0, 2, 5
"""Kinds of channels beside colours."""
_MAX_HEADER = 1 << 12
"""Bytes, of which names of channels are the most."""
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


class ImageHeader(NamedTuple):
    """bits: of a sample, 0 where a preview hides it and whether this is an animation. others: kinds of channels beside
    colours; is_associated: whether colours are multiplied by alpha.
    """

    bits: int = 8
    is_animation: bool = False
    others: tuple[int, ...] = ()
    is_associated: bool = False


def image_header(data: Bytes) -> ImageHeader | None:
    """What the code stream says of its samples; None where none is found. Raises struct.error."""
    head = bytes(data[:_MAX_HEADER])
    if is_boxed(data):
        found = boxes(data, slice(0, len(data)))
        at = next((span.start + 4 * (kind == b"jxlp") for kind, span in found if kind in (b"jxlc", b"jxlp")), 0)
        head = bytes(data[at : at + _MAX_HEADER])
    if head[:2] != _START:
        return None
    bits, is_animation = _Bits(head[2:]), False
    bits.skip_size()
    if bits.take(1):  # all is as usual
        return ImageHeader()
    if bits.take(1):
        bits.take(_ORIENTATION)
        if bits.take(1):
            bits.skip_size()
        if bits.take(1):
            return ImageHeader(0, True)
        is_animation = bool(bits.take(1))
    if is_animation:
        for lengths in _TIMES:
            bits.take(lengths[bits.take(2)])
        bits.take(1)
    depth = bits.depth()
    bits.take(1)
    others = [bits.channel() for _ in range(bits.number(_COUNT))]
    return ImageHeader(depth, is_animation, tuple(kind for kind, _ in others), any(flag for _, flag in others))


class _Bits:
    """Bits from the lowest one up; zeros after the end."""

    def __init__(self, data: bytes) -> None:
        self._rest = int.from_bytes(data, "little")

    def take(self, count: int) -> int:
        """The next so many, as a number."""
        value, self._rest = self._rest & ((1 << count) - 1), self._rest >> count
        return value

    def number(self, parts: tuple[tuple[int, int], ...]) -> int:
        """One of four kinds, each the least and the bits that add to it."""
        least, more = parts[self.take(2)]
        return least + self.take(more)

    def depth(self) -> int:
        """Pass over what a sample is; its bits."""
        if not self.take(1):
            return self.number(_BITS)
        bits = self.number(_FLOAT_BITS)
        self.take(_EXPONENT)
        return bits

    def channel(self) -> tuple[int, bool]:
        """Pass over what a channel beside colours is; its kind, and whether colours are multiplied by it."""
        if self.take(1):
            return ALPHA, False
        kind = self.number(_KIND)
        self.depth()
        self.number(_SHIFT)
        self.take(8 * self.number(_NAME))
        if kind in (_SPOT, _CFA):
            self.take(_INK) if kind == _SPOT else self.number(_CFA_CHANNEL)
        return kind, kind == ALPHA and bool(self.take(1))

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
