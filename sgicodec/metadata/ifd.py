"""Tag directories (IFDs), the structure that TIFF files and EXIF blobs share (TIFF 6.0 §2, EXIF 3.0 §4.6).

A directory is a dict from tag to `Entry`, or to another directory for the tags that point to one. Reading
normalises values to little-endian, and texts to the type that TIFF has, so what was read from any file can be written
to any other.
"""

from __future__ import annotations

import contextlib
import itertools
import struct
from collections.abc import Container, Mapping
from dataclasses import dataclass
from typing import NamedTuple, Union

from sgicodec.metadata.filebytes import Bytes

EXIF_IFD, GPS_IFD, INTEROP_IFD = 34665, 34853, 40965
"""Tags whose value is the offset of a subordinate directory."""

_VALUE_SIZE = {
    1: 1,
    2: 1,
    3: 2,
    4: 4,
    5: 8,
    6: 1,
    7: 1,
    8: 2,
    9: 4,
    10: 8,
    11: 4,
    12: 8,
    13: 4,
    16: 8,
    17: 8,
    18: 8,
    129: 1,
}
"""Bytes of one value of each TIFF type; 16 to 18 are BigTIFF's, 129 is EXIF 3.0's text in UTF-8."""

_RATIONALS = (5, 10)
_SHORT, _LONG, _LONG8 = 3, 4, 16
_ASCII, _UTF8 = 2, 129


class Entry(NamedTuple):
    """Values of one tag: their TIFF type and their bytes, little-endian."""

    kind: int
    data: bytes

    @property
    def short(self) -> int:
        """The first value of a tag of short integers."""
        return int.from_bytes(self.data[:2], "little")


Directory = dict[int, Union[Entry, "Directory"]]


@dataclass(frozen=True)
class Layout:
    """How a file spells its directories: byte order, classic (32-bit) or BigTIFF (64-bit) offsets."""

    order: str
    big: bool

    @property
    def count(self) -> struct.Struct:
        """The number of rows, first in a directory."""
        return struct.Struct(self.order + ("Q" if self.big else "H"))

    @property
    def row(self) -> struct.Struct:
        """Tag, type, number of values, and the values themselves or their offset."""
        return struct.Struct(self.order + ("HHQ8s" if self.big else "HHI4s"))

    @property
    def offset(self) -> struct.Struct:
        """An offset from the start of the file."""
        return struct.Struct(self.order + ("Q" if self.big else "I"))

    @property
    def first(self) -> int:
        """Where the file keeps the offset of its first directory."""
        return 8 if self.big else 4


class Row(NamedTuple):
    """One row of a directory as it stands in the file; `at` is the offset of its value field."""

    tag: int
    kind: int
    values: int
    at: int


def layout(data: Bytes) -> Layout | None:
    """How `data` spells its directories, or None if it does not begin like a TIFF."""
    head = bytes(data[:4])
    known = {b"II*\0": ("<", False), b"MM\0*": (">", False), b"II+\0": ("<", True), b"MM\0+": (">", True)}
    return Layout(*known[head]) if head in known else None


def rows(data: Bytes, at: int, spelling: Layout) -> list[Row]:
    """The rows of the directory at byte `at`. Raises struct.error if it reaches past the end."""
    (count,) = spelling.count.unpack(data[at : at + spelling.count.size])
    at += spelling.count.size
    if at + count * spelling.row.size > len(data):
        raise struct.error("directory reaches past the end")
    table = data[at : at + count * spelling.row.size]
    offsets = itertools.count(at + spelling.row.size - spelling.offset.size, spelling.row.size)
    found = zip(spelling.row.iter_unpack(table), offsets, strict=False)
    return [Row(tag, kind, values, offset) for (tag, kind, values, _), offset in found]


def tags(data: Bytes) -> list[int]:
    """Those of the first directory; none of what is no TIFF structure. Raises struct.error if it is damaged."""
    spelling = layout(data)
    return [] if spelling is None else [row.tag for row in rows(data, first_directory(data, spelling), spelling)]


def first_directory(data: Bytes, spelling: Layout) -> int:
    """Place of the first directory. Raises struct.error if there is none."""
    return offset(data, spelling.first, spelling)


def offset(data: Bytes, at: int, spelling: Layout) -> int:
    """The offset that stands at byte `at`. Raises struct.error past the end."""
    return int(spelling.offset.unpack(data[at : at + spelling.offset.size])[0])


def first_integer(data: Bytes, row: Row, spelling: Layout) -> int:
    """The first value of a row of short or long integers; what stands there of any other."""
    letter = {_SHORT: "H", _LONG: "I"}.get(row.kind)
    form = spelling.offset if letter is None else struct.Struct(spelling.order + letter)
    return int(form.unpack(data[row.at : row.at + form.size])[0])


def entries(data: Bytes | None, only: Container[int]) -> dict[int, Entry]:
    """The values of the tags in `only` of the first directory, as far as they are sound; none of what is no TIFF
    structure, or None.
    """
    try:
        found = {} if data is None else load(data, only)
    except struct.error:
        return {}
    return {tag: item for tag, item in found.items() if isinstance(item, Entry)}


def damage(data: Bytes) -> str | None:
    """What is wrong with the first directory of a TIFF file, or None; OpenImageIO leaves out tags that are cut off."""
    spelling = layout(data)
    if spelling is None:
        return None
    try:
        for row in rows(data, first_directory(data, spelling), spelling):
            start, size = _extent(data, row, spelling)
            if start + size > len(data):
                return f"the file is damaged or cut off, the values of its TIFF tag {row.tag} lie outside"
    except struct.error:
        return "the file is damaged or cut off, its TIFF directory lies outside"
    return None


def load(data: Bytes, only: Container[int] | None = None) -> Directory:
    """The first directory of a TIFF structure, with its EXIF, GPS and interoperability directories; of the first only
    the tags in `only`, if stated.

    Values and subordinate directories that are damaged are left out. Raises struct.error if the first directory is.
    """
    spelling = layout(data)
    if spelling is None:
        raise struct.error("not a TIFF structure")
    return _load(data, first_directory(data, spelling), spelling, (EXIF_IFD, GPS_IFD), only)


def _load(
    data: Bytes, at: int, spelling: Layout, pointers: tuple[int, ...], only: Container[int] | None = None
) -> Directory:
    directory: Directory = {}
    for row in rows(data, at, spelling):
        if only is not None and row.tag not in only:
            continue
        start, size = _extent(data, row, spelling)
        if size == 0 or start + size > len(data):
            continue
        if row.tag in pointers:
            inner = (INTEROP_IFD,) if row.tag == EXIF_IFD else ()
            with contextlib.suppress(struct.error):
                directory[row.tag] = _load(data, offset(data, row.at, spelling), spelling, inner)
        else:
            kind = _ASCII if row.kind == _UTF8 else row.kind  # which readers of TIFF do not know
            directory[row.tag] = Entry(kind, _little(bytes(data[start : start + size]), row.kind, spelling))
    return directory


def _extent(data: Bytes, row: Row, spelling: Layout) -> tuple[int, int]:
    """Start and length in bytes of a row's values; no length if their type is unknown."""
    size = _VALUE_SIZE.get(row.kind, 0) * row.values
    return (row.at if size <= spelling.offset.size else offset(data, row.at, spelling)), size


def _little(values: bytes, kind: int, spelling: Layout) -> bytes:
    size = 4 if kind in _RATIONALS else _VALUE_SIZE[kind]
    if spelling.order == "<" or size == 1:
        return values
    found = bytearray(len(values))
    for byte in range(size):
        found[byte::size] = values[size - 1 - byte :: size]
    return bytes(found)


def dump(directory: Mapping[int, Entry | Directory], start: int, *, big: bool = False) -> bytes:
    """Little-endian bytes of a directory that will stand at byte `start` (even), its values and
    subdirectories behind it.
    """
    spelling = Layout("<", big)
    table = bytearray(spelling.count.pack(len(directory)))
    behind = start + len(table) + len(directory) * spelling.row.size + spelling.offset.size
    tail = bytearray()
    for tag, item in sorted(directory.items()):
        place = spelling.offset.pack(behind + len(tail))
        if isinstance(item, dict):
            table += spelling.row.pack(tag, _LONG8 if big else _LONG, 1, place)
            tail += dump(item, behind + len(tail), big=big)
            continue
        count = len(item.data) // _VALUE_SIZE[item.kind]
        inline = len(item.data) <= spelling.offset.size
        table += spelling.row.pack(tag, item.kind, count, item.data if inline else place)
        if not inline:
            tail += item.data + bytes(len(item.data) % 2)
    return bytes(table + spelling.offset.pack(0) + tail)
