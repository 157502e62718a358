"""What a JPEG 2000 file says besides samples (ISO/IEC 15444-1): its components, and EXIF, XMP and `geo` in boxes under
a UUID each (§I.7.2).

The place is GeoJP2's, a TIFF without pixels. GML, which may state it too, is left to GDAL.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import NamedTuple

from sgicodec.metadata import tiff
from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.boxes import boxes
from sgicodec.metadata.filebytes import Bytes

_SIGNATURE = b"\0\0\0\x0cjP  \r\n\x87\n"
_GEO = bytes.fromhex("b14bf8bd083d4b43a5ae8cd7d5a6ce03")
_XMP = bytes.fromhex("be7acfcb97a942e89c71999491e3afac")
_EXIF = b"JpgTiffExif->JP2"
_GML = b"gml.data"
_CODE_STREAM, _SIGNED = b"\xff\x4f\xff\x51", 128
"""How a code stream begins, and the bit that says that a component is signed."""


_MAX_SIDE = (1 << 31) - 1
_OTHER_RGB = {20: "e-sRGB", 21: "ROMM-RGB"}
_OPACITY, _PREMULTIPLIED = 1, 2
"""Kinds of channels that are no colours."""


class Components(NamedTuple):
    """width, height: of the picture. depths: a byte for each component, 128 if it is signed, and its number of bits
    less 1. has_alpha: whether the last one is declared as opacity; has_opacity: whether one is; is_associated: whether
    colours are multiplied by it.
    """

    width: int
    height: int
    depths: bytes
    has_alpha: bool
    has_opacity: bool = False
    is_associated: bool = False

    @property
    def is_deep(self) -> bool:
        """Whether samples are signed or have more than 16 bits."""
        return any(depth >= _SIGNED or depth >= 16 for depth in self.depths)

    @property
    def bits(self) -> int:
        """Of the deepest component."""
        return 1 + max(depth & 127 for depth in self.depths)

    @property
    def sample(self) -> str:
        """The type that holds the samples of all components."""
        signs = {depth >= _SIGNED for depth in self.depths}
        size = 32 if self.bits > 16 or len(signs) > 1 else 16 if self.bits > 8 else 8
        return f"{'int' if True in signs else 'uint'}{size}"


def is_boxed(data: Bytes) -> bool:
    """Whether a file begins like one of JPEG 2000 in boxes; one without has no metadata."""
    return bytes(data[: len(_SIGNATURE)]) == _SIGNATURE


def is_jpeg2000(head: bytes) -> bool:
    """Whether a file that begins so is one, in boxes or without."""
    return is_boxed(head) or head[:4] == _CODE_STREAM


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


def components(data: Bytes) -> Components | None:
    """What the segment SIZ of the code stream says (§A.5.1); None where none is found, or no size of a picture. Raises
    struct.error.
    """
    start = 0 if data[:4] == _CODE_STREAM else _box(data, b"jp2c")
    if start is None or data[start : start + 4] != _CODE_STREAM:
        return None
    right, bottom, left, top, count = struct.unpack(">4I16xH", data[start + 8 : start + 42])
    depths = bytes(data[start + 42 : start + 42 + 3 * count][::3])
    channels = _channels(data)
    has_alpha = bool({(count - 1, _OPACITY), (count - 1, _PREMULTIPLIED)} & channels)
    kinds = {kind for _, kind in channels}
    has_opacity, is_associated = bool(kinds & {_OPACITY, _PREMULTIPLIED}), _PREMULTIPLIED in kinds
    found = Components(right - left, bottom - top, depths, has_alpha, has_opacity, is_associated)
    is_picture = len(depths) == count > 0 and 0 < found.width <= _MAX_SIDE and 0 < found.height <= _MAX_SIDE
    return found if is_picture else None


def _channels(data: Bytes) -> set[tuple[int, int]]:
    """The number and kind of each channel in the box `cdef`."""
    at = _box(data, b"cdef")
    (stated,) = struct.unpack(">H", data[at : at + 2]) if at is not None else (0,)
    places = range((at or 0) + 2, (at or 0) + 2 + 6 * stated, 6)
    return {struct.unpack(">HH", data[place : place + 4]) for place in places}


def insert(data: Bytes, _: Metadata) -> Iterator[bytes]:
    """The file in pieces. Of four components, its header declares the last one as opacity, as OpenImageIO does not."""
    found = components(data)
    headers = [span for kind, span in boxes(data, slice(0, len(data))) if kind == b"jp2h"]
    if found is None or len(found.depths) != 4 or found.has_opacity or not headers:
        yield bytes(data[0 : len(data)])
        return
    rows = b"".join(struct.pack(">HHH", number, 0, number + 1) for number in range(3)) + struct.pack(">HHH", 3, 1, 0)
    box = struct.pack(">I4sH", 10 + len(rows), b"cdef", 4) + rows
    start, stop = headers[0].start - 8, headers[0].stop
    yield bytes(data[0:start]) + struct.pack(">I", stop - start + len(box)) + bytes(data[start + 4 : stop]) + box
    yield bytes(data[stop : len(data)])


def left_behind(data: Bytes) -> list[str]:
    """The colour space, where it is RGB of another one than sRGB. Raises struct.error."""
    name = _OTHER_RGB.get(colour_space(data) or 0)
    return [f"colour space ({name})"] if name else []


def colour_space(data: Bytes) -> int | None:
    """The enumerated colour space in the box `colr`; None if it states none. Raises struct.error."""
    at = _box(data, b"colr")
    method, space = struct.unpack(">BxxI", data[at : at + 7]) if at is not None else (0, 0)
    return int(space) if method == 1 else None


def _box(data: Bytes, wanted: bytes) -> int | None:
    """Where the contents of the first box of this kind begin, in the file or its header; None if there is none."""
    if not is_boxed(data):
        return None
    for kind, span in boxes(data, slice(0, len(data))):
        if kind == wanted:
            return int(span.start)
        if kind == b"jp2h":
            within = [inner for name, inner in boxes(data, span) if name == wanted]
            if within:
                return int(within[0].start)
    return None
