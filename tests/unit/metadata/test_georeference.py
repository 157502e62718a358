"""Places and resolutions in words, from tags made by hand."""

from __future__ import annotations

import struct

import pytest

from sgicodec.metadata import geo, ifd
from sgicodec.metadata.georeference import georeference, resolution

UTM = b"WGS 84 / UTM zone 33N|WGS 84|"


def doubles(*values: float) -> ifd.Entry:
    return ifd.Entry(12, struct.pack(f"<{len(values)}d", *values))


def keys(*rows: tuple[int, int, int, int]) -> ifd.Entry:
    flat = [1, 1, 0, len(rows), *(value for row in rows for value in row)]
    return ifd.Entry(3, struct.pack(f"<{len(flat)}H", *flat))


PROJECTED = [(1024, 0, 1, 1), (1025, 0, 1, 1), (1026, 34737, 22, 0), (3072, 0, 1, 32633), (3076, 0, 1, 9001)]
TIED = {33550: doubles(10, 20, 0), 33922: doubles(0, 0, 0, 5e5, 6e6, 0)}


def test_a_projected_picture() -> None:
    found = georeference(geo.pack({**TIED, 34735: keys(*PROJECTED), 34737: ifd.Entry(2, UTM + b"\0")}), 100, 50)
    assert found is not None
    assert (found.epsg, found.name, found.unit, found.rotated) == (32633, "WGS 84 / UTM zone 33N", "m", False)
    assert found.bounds == (5e5, 6e6 - 1000, 5e5 + 1000, 6e6)
    assert found.pixel_size == (10, 20)


def test_tie_points_may_be_centres() -> None:
    """PixelIsPoint: the tie point is the centre of the first pixel, so the picture reaches half a pixel further."""
    rows = [(1024, 0, 1, 2), (1025, 0, 1, 2), (2048, 0, 1, 4326)]
    found = georeference(geo.pack({**TIED, 34735: keys(*rows)}), 100, 50)
    assert found is not None
    assert (found.epsg, found.name, found.unit) == (4326, None, "°")
    assert found.bounds == (5e5 - 5, 6e6 + 10 - 1000, 5e5 + 995, 6e6 + 10)


def rational(value: int, below: int = 1) -> ifd.Entry:
    return ifd.Entry(5, struct.pack("<II", value, below))


def directory(**tags: ifd.Entry) -> bytes:
    return b"II*\0\x08\0\0\0" + ifd.dump({int(tag.removeprefix("t")): entry for tag, entry in tags.items()}, 8)


@pytest.mark.parametrize(("unit", "microns"), [(2, 25400 / 50800), (3, 10000 / 50800)])
def test_resolution_of_tags(unit: int, microns: float) -> None:
    tags = {"t282": rational(50800), "t283": rational(25400), "t296": ifd.Entry(3, struct.pack("<H", unit))}
    for found in (
        resolution(geo.pack({int(tag[1:]): entry for tag, entry in tags.items()}), None),
        resolution(None, directory(**tags)),
    ):
        assert found is not None
        assert found.microns == pytest.approx((microns, 2 * microns))
        assert found.stated == f"50800 × 25400 pixels per {'inch' if unit == 2 else 'cm'}"


def test_resolution_of_slides() -> None:
    text = b"Aperio Image Library v10.0.51|AppMag = 40|MPP = 0.2520|Left = 1"
    found = resolution(None, directory(t270=ifd.Entry(2, text + b"\0"), t282=rational(1), t283=rational(1)))
    assert found is not None
    assert found.microns == (0.252, 0.252)
