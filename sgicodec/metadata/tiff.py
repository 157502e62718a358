"""EXIF, XMP and the tags of `geo` in the first directory of a TIFF file.

JPEG, PNG and WebP carry EXIF as one blob, a small TIFF of its own. A TIFF file has the same tags scattered over its own
directory, where they stand among those that describe the pixels.
"""

from __future__ import annotations

import struct
from pathlib import Path

from sgicodec.metadata import geo, ifd
from sgicodec.metadata.filebytes import Bytes, FileBytes
from sgicodec.metadata.pages import PageBytes
from sgicodec.metadata.stacks import states_shape, without_shape

_BYTE, _SHORT = 1, 3
_PHOTOMETRIC, _EXTRA_SAMPLES = 262, 338
_DATETIME = 306
DESCRIPTION, XMP = 270, 700

_DESCRIPTIVE = {269, DESCRIPTION, 271, 272, 305, _DATETIME, 315, 316, 18246, 18249, 33432, *range(40091, 40096)}
"""Document name, description, make, model, software, date, artist, host, ratings, copyright, Windows' tags."""

_EXIF = _DESCRIPTIVE | geo.RESOLUTION | {ifd.EXIF_IFD, ifd.GPS_IFD}
KEPT = _EXIF | geo.TAGS | {XMP}
"""Tags that a stream keeps."""

STRUCTURE = {
    *(*range(254, 269), *range(273, 282), 284, *range(288, 294), 297, 301, *range(317, 321), *range(322, 331)),
    *(*range(332, 337), *range(338, 342), 347, *range(512, 522), *range(529, 533), 559, 34675),
    *({*range(50706, 51200)} - {51023}),  # of DNG, but for Fibics, who make microscopes
} - _EXIF
"""Tags of the first directory that say how pixels are stored or become colours; what they lose is said by name."""

_NO_UNIT = ifd.Entry(3, b"\1\0")


def find(data: Bytes) -> tuple[bytes | None, bytes | None, bytes | None]:
    """EXIF blob, XMP packet and `geo` blob of a TIFF file.

    A directory with nothing but a resolution is no EXIF; the resolution is then in `geo`. A description that states the
    shape of a stack is left behind.
    """
    try:
        directory = without_shape(of_stack(data) | ifd.load(data, KEPT))
    except struct.error:
        return None, None, None
    xmp = directory.pop(XMP, None)
    carried = {tag: item for tag, item in directory.items() if tag in _EXIF}
    exif = b"II*\0\x08\0\0\0" + ifd.dump(carried, 8) if carried.keys() - geo.RESOLUTION else None
    if exif is not None or _says_nothing(directory):
        directory = {tag: item for tag, item in directory.items() if tag not in geo.RESOLUTION}
    return exif, xmp.data if isinstance(xmp, ifd.Entry) else None, geo.pack(directory)


def of_stack(data: Bytes) -> ifd.Directory:
    """The description of the whole stack, where `data` stands for another page than the first, which has it."""
    first = ifd.load(data.whole, {DESCRIPTION}) if isinstance(data, PageBytes) else {}
    return first if states_shape(first) else {}


def _says_nothing(directory: ifd.Directory) -> bool:
    """Whether the resolution is the same in x and y and without a unit."""
    across, down, unit = (directory.get(tag) for tag in sorted(geo.RESOLUTION))
    return across == down and unit == _NO_UNIT


def described(exif: bytes | None) -> dict[int, ifd.Entry]:
    """The descriptive tags of an EXIF blob, and its resolution; none of a damaged one."""
    return ifd.entries(exif, _DESCRIPTIVE | geo.RESOLUTION)


def insert(
    path: Path, exif: bytes | None, xmp: bytes | None, georeference: bytes | None, bands: int | None = None
) -> None:
    """Give the little-endian TIFF file at `path` the tags of an EXIF blob, an XMP packet and a `geo` blob.

    bands: their number where channels have no meaning, which OpenImageIO would call red, green and blue.
    A new first directory is appended and the header made to point at it. The time of writing, which a library
    may have stamped, gives way to the blob's date or to none, so that equal pictures make equal files. Raises
    struct.error for damaged EXIF, and if a classic TIFF has no room left.
    """
    with path.open("r+b") as file:
        data = FileBytes(file)
        spelling = ifd.layout(data)
        directory = ifd.load(data)
        end = len(data) + len(data) % 2
        if spelling is None or spelling.order != "<":
            raise struct.error("not a little-endian TIFF")
        directory.pop(_DATETIME, None)
        if exif is not None:
            stated, taken = ifd.load(exif), STRUCTURE | geo.TAGS | {XMP, *directory}
            directory |= {tag: item for tag, item in stated.items() if tag in _EXIF or tag not in taken}
        if xmp is not None:
            directory[XMP] = ifd.Entry(_BYTE, xmp)
        directory |= geo.load(georeference)
        if bands is not None:
            directory[_PHOTOMETRIC] = ifd.Entry(_SHORT, b"\1\0")  # 0 is black
            directory |= {_EXTRA_SAMPLES: ifd.Entry(_SHORT, bytes(2 * (bands - 1)))} if bands > 1 else {}
        file.seek(end)
        file.write(ifd.dump(directory, end, big=spelling.big))
        file.seek(spelling.first)
        file.write(spelling.offset.pack(end))
