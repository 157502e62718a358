"""Tags of TIFF and the blobs that hold them, as files state them."""

from __future__ import annotations

import struct

from sgicodec.metadata import geo, ifd


def doubles(*values: float) -> ifd.Entry:
    return ifd.Entry(12, struct.pack(f"<{len(values)}d", *values))


def shorts(*values: int) -> ifd.Entry:
    return ifd.Entry(3, struct.pack(f"<{len(values)}H", *values))


def rational(above: int, below: int = 1) -> ifd.Entry:
    return ifd.Entry(5, struct.pack("<II", above, below))


def text(value: str | bytes) -> ifd.Entry:
    return ifd.Entry(2, (value.encode() if isinstance(value, str) else value) + b"\0")


def geo_keys(*rows: tuple[int, int, int, int]) -> ifd.Entry:
    """A GeoKeyDirectory."""
    return shorts(1, 1, 0, len(rows), *(value for row in rows for value in row))


TIED = {33550: doubles(10, 10, 0), 33922: doubles(0, 0, 0, 5e5, 6e6, 0)}
"""A place on the map: pixels of ten metres."""


def geo_of(tags: dict[int, ifd.Entry]) -> bytes:
    """A `geo` blob."""
    blob = geo.pack(tags)
    assert blob
    return blob


def exif_of(tags: ifd.Directory) -> bytes:
    """An EXIF blob."""
    return b"II*\0\x08\0\0\0" + ifd.dump(tags, 8)


def exif_blob(orientation: int = 6, order: str = "<") -> bytes:
    """An EXIF blob by hand: a maker, an orientation, and an EXIF directory with a lens model."""
    rows = [(271, 2, 6, 50), (274, 3, 1, orientation if order == "<" else orientation << 16), (34665, 4, 1, 56)]
    head = (b"II*\0" if order == "<" else b"MM\0*") + struct.pack(order + "IH", 8, len(rows))
    table = b"".join(struct.pack(order + "HHII", *row) for row in rows)
    lens = struct.pack(order + "HHHI4sI", 1, 42036, 2, 4, b"50m\0", 0)
    return head + table + bytes(4) + b"Maker\0" + lens
