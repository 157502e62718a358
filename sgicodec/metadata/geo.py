"""Tags of TIFF that say where a picture lies and what its numbers mean: GeoTIFF (OGC 19-008r4), GDAL's own, resolution.

They travel as one blob, a little-endian TIFF structure whose only directory holds them and nothing else
(docs/pictures.md has its bytes). Nothing here interprets a coordinate system.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from sgicodec.metadata import gdal, ifd

if TYPE_CHECKING:
    import numpy as np

PIXEL_SCALE, TIEPOINTS, MATRIX, RPC = 33550, 33922, 34264, 50844
KEYS, _KEY_DOUBLES, KEY_TEXTS = 34735, 34736, 34737
GDAL_METADATA, GDAL_NODATA = 42112, 42113

RESOLUTION = frozenset({282, 283, 296})
"""Pixels per unit in x and in y, and the unit: 1 none, 2 inch, 3 centimetre."""

TAGS = RESOLUTION | {
    *(PIXEL_SCALE, TIEPOINTS, MATRIX, RPC),
    *(KEYS, _KEY_DOUBLES, KEY_TEXTS),
    *(GDAL_METADATA, GDAL_NODATA),
}
"""All that a blob may hold; others are left behind."""

PLACE = frozenset({PIXEL_SCALE, TIEPOINTS, MATRIX, RPC})
"""Those that tie pixels to places."""

_ASCII = 2


def pack(directory: Mapping[int, ifd.Entry | ifd.Directory]) -> bytes | None:
    """The blob of those entries of a directory that belong in it, or None if there are none."""
    entries = {tag: directory[tag] for tag in sorted(directory.keys() & TAGS)}
    return b"II*\0\x08\0\0\0" + ifd.dump(entries, 8) if entries else None


def load(blob: bytes | None) -> dict[int, ifd.Entry]:
    """The entries of a blob; none if it is damaged or None."""
    return ifd.entries(blob, TAGS)


def has_place(blob: bytes | None) -> bool:
    """Whether a blob says where the picture lies."""
    return bool(load(blob).keys() & PLACE)


def nodata(blob: bytes | None, dtype: np.dtype[Any]) -> float | None:
    """The sample value that means "nothing was measured here", exactly as a sample of `dtype` would hold it.

    None if there is none, or none that such a sample can have. It may be not-a-number or infinite.
    """
    entry = load(blob).get(GDAL_NODATA)
    if entry is None:
        return None
    import numpy as np

    value = gdal.number(entry.data.split(b"\0", 1)[0])
    if value is None:
        return None
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        return value if limits.min <= value <= limits.max and value == int(value) else None
    with np.errstate(over="ignore"):
        return float(dtype.type(value))


def without_statistics(blob: bytes | None) -> bytes | None:
    """The blob for a picture whose samples are not exactly the same any more: GDAL's statistics and histograms of them
    are left behind.
    """
    entries = load(blob)
    found = _with_metadata(entries, gdal.without_statistics)
    return blob if found == entries else pack(found)


def _with_metadata(entries: dict[int, ifd.Entry], change: Callable[[bytes], bytes]) -> dict[int, ifd.Entry]:
    """The entries with another text of GDAL's metadata, without it where nothing is left."""
    entry = entries.get(GDAL_METADATA)
    text = b"" if entry is None else change(entry.data)
    rest = {tag: other for tag, other in entries.items() if tag != GDAL_METADATA}
    return {**rest, GDAL_METADATA: ifd.Entry(_ASCII, text)} if text else rest


def resampled(blob: bytes | None, convert: Callable[[float], float | None]) -> bytes | None:
    """The blob for a picture whose samples are now other numbers: `convert` gives the new nodata value, None for none.

    GDAL's scales, offsets, units and statistics of samples are left behind: they are no longer true.
    """
    entries = _with_metadata(load(blob), gdal.without_numbers)
    if entries.pop(GDAL_NODATA, None) is not None:
        import numpy as np

        old = nodata(blob, np.dtype(np.float64))
        new = None if old is None else convert(old)
        if new is not None:
            entries[GDAL_NODATA] = _of_nodata(new)
    return pack(entries)


def with_nodata(blob: bytes | None, value: float) -> bytes | None:
    """The blob, which says that samples of this value stand for nothing if it does not say so of others."""
    entries = load(blob)
    return blob if GDAL_NODATA in entries else pack({**entries, GDAL_NODATA: _of_nodata(value)})


def _of_nodata(value: float) -> ifd.Entry:
    return ifd.Entry(_ASCII, f"{value:.17g}".encode("ascii") + b"\0")
