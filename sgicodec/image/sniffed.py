"""Pictures that need a library of their own: HEIF, AVIF and raw files of cameras, known by their content.

A raw file often begins like a TIFF whose first picture is a small preview: read as TIFF, it would lose the photograph.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from typing import Literal, NamedTuple

from sgicodec.metadata import ifd
from sgicodec.metadata.avif import is_avif
from sgicodec.metadata.filebytes import Bytes


class SniffedFormat(NamedTuple):
    """name: of the format, for HEIF and raw files that of OpenImageIO; what it is; program: that makes another picture
    of it.
    """

    name: Literal["heif", "avif", "raw"]
    what: str
    program: str


_HEIF = (b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"mif1", b"msf1")
_RAW = (
    (0, b"FUJIFILMCCD-RAW", "RAF"),
    (0, b"IIRO", "ORF"),
    (0, b"IIRS", "ORF"),
    (0, b"MMOR", "ORF"),
    (0, b"IIU\0", "RW2"),
    (0, b"FOVb", "X3F"),
    (0, b"\0MRM", "MRW"),
    (4, b"ftypcrx ", "CR3"),
    (8, b"CR\x02\0", "CR2"),
)

_WIDTH, _HEIGHT = 256, 257
_KIND, _REDUCED = 254, 1
_SUB_IFDS, _PHOTOMETRIC, _DNG_VERSION = 330, 262, 50706
_SENSOR = (32803, 34892)
"""Photometric interpretations of samples as a sensor gives them: behind colour filters, or linear."""

_MAX_DIRECTORIES = 16


def sniffed_format(data: Bytes) -> SniffedFormat | None:
    """What such a file is; None for all other files."""
    if is_avif(data):
        program = "convert it first, as with avifdec of libavif: avifdec --depth 16 IN a.png"
        return SniffedFormat("avif", "an AVIF picture", program)
    head = bytes(data[:16])
    brand = head[8:12] if head[4:8] == b"ftyp" else b""
    if brand in _HEIF:
        program = "convert it first, as with heif-convert of libheif: heif-convert IN a.png"
        return SniffedFormat("heif", "a HEIF picture (HEIC)", program)
    name = next((name for at, start, name in _RAW if head[at : at + len(start)] == start), None)
    name = name or _tiff_raw(data)
    if name is None:
        return None
    program = "develop it first, as with darktable: darktable-cli IN a.tif"
    return SniffedFormat("raw", f"a camera's raw file ({name})", program)


def _tiff_raw(data: Bytes) -> str | None:
    """What is said of a TIFF structure that holds samples of a sensor: DNG, NEF, ARW, PEF and others."""
    spelling = ifd.layout(data)
    if spelling is None:
        return None
    try:
        for directory in _directories(data, spelling):
            if _DNG_VERSION in directory:
                return "DNG"
            if directory.get(_PHOTOMETRIC) in _SENSOR:
                return "of the TIFF family"
    except struct.error:
        pass  # damage is for others to name
    return None


def larger_below(data: Bytes) -> tuple[int, int] | None:
    """Width and height of a picture below the first directory of a TIFF that is larger; None if there is none."""
    spelling = ifd.layout(data)
    if spelling is None:
        return None
    try:
        own, *below = ((found.get(_WIDTH, 0), found.get(_HEIGHT, 0)) for found in _directories(data, spelling))
    except struct.error:
        return None
    largest = max(below, default=own, key=math.prod)
    return largest if math.prod(largest) > math.prod(own) else None


def others_below(data: Bytes) -> list[str]:
    """What is said of pictures below the first directory of a TIFF that do not call themselves reductions of it."""
    spelling = ifd.layout(data)
    try:
        below = [] if spelling is None else list(_directories(data, spelling))[1:]
    except struct.error:
        return []
    count = sum(_WIDTH in found and not found.get(_KIND, 0) & _REDUCED for found in below)
    return [f"{count} picture{'s' * (count > 1)} in sub-directories"] if count else []


def _directories(data: Bytes, spelling: ifd.Layout) -> Iterator[dict[int, int]]:
    """First values of the tags of the first directory, then of those below it."""
    first = {row.tag: row for row in ifd.rows(data, ifd.first_directory(data, spelling), spelling)}
    yield {tag: ifd.first_integer(data, row, spelling) for tag, row in first.items()}
    below = first.get(_SUB_IFDS)
    if below is None:
        return
    single = below.values * spelling.offset.size <= spelling.offset.size
    start = below.at if single else ifd.offset(data, below.at, spelling)
    for index in range(min(below.values, _MAX_DIRECTORIES)):
        at = ifd.offset(data, start + index * spelling.offset.size, spelling)
        yield {row.tag: ifd.first_integer(data, row, spelling) for row in ifd.rows(data, at, spelling)}
