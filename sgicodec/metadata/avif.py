"""What the boxes of an AVIF file say of its primary picture: bits, crop and turn, which libavif leaves to others.

Boxes are those of ISO/IEC 14496-12, properties of pictures those of ISO/IEC 23008-12 (HEIF) and 23000-22 (MIAF).
"""

from __future__ import annotations

import struct
from fractions import Fraction
from typing import NamedTuple

from sgicodec.errors import PictureError
from sgicodec.metadata.boxes import boxes
from sgicodec.metadata.filebytes import Bytes
from sgicodec.metadata.orientation import Window

_MAX_META = 1 << 24
"""Bytes of the box `meta`, which holds no pixels; those of EXIF and profiles may lie in it."""

_TURNS = {
    (0, None): 1,
    (0, 1): 2,
    (2, None): 3,
    (0, 0): 4,
    (1, 0): 5,
    (3, None): 6,
    (1, 1): 7,
    (1, None): 8,
    (2, 0): 2,
    (2, 1): 4,
    (3, 0): 7,
    (3, 1): 5,
}
"""Orientations by quarter turns against the clock and, after them, which halves change places: 0 top and bottom, 1 left
and right, None none.
"""


_ALPHA = (b"urn:mpeg:mpegB:cicp:systems:auxiliary:alpha", b"urn:mpeg:hevc:2015:auxid:1")
_GAIN_MAP = b"tmap"
"""What is said of an auxiliary picture that is alpha, and the kind of an item that a gain map makes."""


class Still(NamedTuple):
    """The primary picture as it is stored: samples of so many bits; crop: what of it is meant to be seen; orientation:
    how that is turned then, 1 to 8; colours: numbers of primaries and transfer function, if nothing else states them.
    """

    width: int
    height: int
    bits: int
    is_gray: bool
    crop: Window
    orientation: int
    colours: tuple[int, int] | None = None
    has_more: bool = False
    """Whether there is a gain map, or another auxiliary picture than alpha, such as depth."""


def is_avif(data: Bytes) -> bool:
    """Whether the box that begins a file says so, by its main brand or, of HEIF in general, by another one."""
    head = bytes(data[:16])
    if head[4:8] != b"ftyp":
        return False
    brands = bytes(data[16 : min(int.from_bytes(head[:4], "big"), 1024)])
    others = {brands[at : at + 4] for at in range(0, len(brands), 4)}
    return head[8:12] in (b"avif", b"avis") or (head[8:12] in (b"mif1", b"msf1") and b"avif" in others)


def still(data: Bytes) -> Still:
    """The primary picture of an AVIF file. Raises PictureError for damage and for what is not read."""
    try:
        return _still(data)
    except (struct.error, IndexError, ZeroDivisionError) as error:
        raise PictureError("the file is damaged or cut off: its boxes do not hold what they must") from error


def _still(data: Bytes) -> Still:
    found = next((span for kind, span in boxes(data, slice(0, len(data))) if kind == b"meta"), None)
    if found is None or found.stop - found.start > _MAX_META:
        raise PictureError("the file is damaged or cut off: it says nothing of a picture")
    meta = bytes(data[found])
    parts = dict(boxes(meta, slice(4, len(meta))))
    if b"pitm" not in parts or b"iprp" not in parts:
        raise PictureError("it holds no single picture")
    inner = dict(boxes(meta, parts[b"iprp"]))
    listed = [(kind, meta[span]) for kind, span in boxes(meta, inner[b"ipco"])] if b"ipco" in inner else []
    primary = _primary(meta[parts[b"pitm"]])
    own = [listed[index - 1] for index in _properties(meta[inner.get(b"ipma", slice(0))], primary) if index]
    sizes = [struct.unpack_from(">II", value, 4) for kind, value in own if kind == b"ispe"]
    width, height = sizes[0]
    bits, is_gray = _samples(own, listed)
    stated = {value[:4]: value[4:] for kind, value in own if kind == b"colr"}
    colours = struct.unpack_from(">HH", stated[b"nclx"]) if set(stated) == {b"nclx"} else None
    has_aux = any(kind == b"auxC" and value[4:].rstrip(b"\0") not in _ALPHA for kind, value in listed)
    has_more = has_aux or _GAIN_MAP in _kinds(meta, parts.get(b"iinf"))
    return Still(width, height, bits, is_gray, *_transforms(own, width, height), colours, has_more)


def _primary(pitm: bytes) -> int:
    form = ">I" if pitm[0] else ">H"
    return int(struct.unpack_from(form, pitm, 4)[0])


def _kinds(meta: bytes, iinf: slice | None) -> list[bytes]:
    """That of each item."""
    if iinf is None:
        return []
    items = slice(iinf.start + (8 if meta[iinf.start] else 6), iinf.stop)
    starts = (span.start for kind, span in boxes(meta, items) if kind == b"infe")
    return [meta[at + 10 : at + 14] if meta[at] > 2 else meta[at + 8 : at + 12] for at in starts]


def _properties(ipma: bytes, item: int) -> list[int]:
    """Numbers, from 1, of the properties of an item in their order; 0 is none."""
    version, is_wide = ipma[0], ipma[3] & 1
    (entries,) = struct.unpack_from(">I", ipma, 4)
    entry = struct.Struct(">IB" if version else ">HB")
    number = struct.Struct(">H" if is_wide else ">B")
    at = 8
    for _ in range(entries):
        name, count = entry.unpack_from(ipma, at)
        at += entry.size
        if name == item:
            mask = 0x7FFF if is_wide else 0x7F  # the bit above: whether a reader must know the property
            return [number.unpack_from(ipma, at + index * number.size)[0] & mask for index in range(count)]
        at += count * number.size
    raise struct.error("the primary picture has no properties")


def _samples(own: list[tuple[bytes, bytes]], listed: list[tuple[bytes, bytes]]) -> tuple[int, bool]:
    """Bits of a sample, and whether there is gray alone. A picture put together of tiles may leave that to them."""
    configurations = [value for kind, value in own if kind == b"av1C"] or [v for kind, v in listed if kind == b"av1C"]
    flags = [value[2] for value in configurations]
    if not flags:
        raise PictureError("its samples are not of AV1, which cannot be read")
    bits = [8 if not flag & 0x40 else 12 if flag & 0x20 else 10 for flag in flags]
    return max(bits), bool(flags[0] & 0x10)


def _transforms(own: list[tuple[bytes, bytes]], width: int, height: int) -> tuple[Window, int]:
    """Crop and orientation. Raises PictureError where they stand in another order, which means something else."""
    order = [kind for kind, _ in own if kind in (b"clap", b"irot", b"imir")]
    if order != sorted(set(order), key=(b"clap", b"irot", b"imir").index):
        raise PictureError("it is cropped, turned and mirrored in another order than is read")
    values = dict(own)
    turn = values[b"irot"][0] & 3 if b"irot" in values else 0
    mirror = values[b"imir"][0] & 1 if b"imir" in values else None
    crop = _crop(values[b"clap"], width, height) if b"clap" in values else (0, 0, width, height)
    return crop, _TURNS[turn, mirror]


def _crop(clap: bytes, width: int, height: int) -> Window:
    """The clean aperture, which is given by its size and how far its centre lies from the picture's."""
    fields = struct.unpack(">IIIIiIiI", clap)
    w, h, right, down = (Fraction(fields[at], fields[at + 1]) for at in range(0, 8, 2))
    x, y = (width - w) / 2 + right, (height - h) / 2 + down
    is_whole = all(value.denominator == 1 for value in (x, y, w, h))
    if not (is_whole and 0 <= x < x + w <= width and 0 <= y < y + h <= height):
        raise PictureError("its crop is not one of whole pixels inside the picture")
    return int(x), int(y), int(w), int(h)
