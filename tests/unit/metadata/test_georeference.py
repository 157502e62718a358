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


def test_a_rotated_picture() -> None:
    found = georeference(geo.pack({34264: doubles(3, 4, 0, 100, 4, -3, 0, 200, *[0.0] * 7, 1)}), 10, 20)
    assert found is not None
    assert (found.epsg, found.name, found.unit, found.rotated) == (None, None, None, True)
    assert found.pixel_size == (5, 5)
    assert found.bounds == (100, 200 - 60, 100 + 30 + 80, 200 + 40)


@pytest.mark.parametrize(
    "blob", [None, b"", b"no blob", geo.pack({42113: ifd.Entry(2, b"0\0")}), geo.pack({33550: doubles(1, 1, 0)})]
)
def test_no_place(blob: bytes | None) -> None:
    assert georeference(blob, 10, 10) is None


def test_a_user_defined_system_has_no_number() -> None:
    found = georeference(geo.pack({**TIED, 34735: keys((3072, 0, 1, 32767), (3073, 34737, 99, 9000))}), 10, 10)
    assert found is not None
    assert (found.epsg, found.name) == (None, None)


BASE = (2048, 0, 1, 4326)
CITED = [(1026, 34737, 10, 0), (2049, 34737, 7, 10)]


@pytest.mark.parametrize(
    ("rows", "epsg", "name", "unit"),
    [
        ([(1024, 0, 1, 1), BASE, *CITED, (3072, 0, 1, 32767), (3076, 0, 1, 9001)], None, "Site grid", "m"),
        ([BASE, *CITED, (3072, 0, 1, 32767), (3076, 0, 1, 32767)], None, "Site grid", None),
        ([(1024, 0, 1, 1), BASE, (2049, 34737, 7, 10), (3074, 0, 1, 32767), (3075, 0, 1, 1)], None, None, None),
        ([BASE, (2049, 34737, 7, 10), (3075, 0, 1, 1)], None, None, None),
        ([(1024, 0, 1, 1), BASE, (3072, 0, 1, 40000)], None, None, None),
        ([(1024, 0, 1, 1), BASE, (3072, 0, 1, 0)], None, None, None),
        ([(1024, 0, 1, 32767), BASE], None, None, None),
        ([(1024, 0, 1, 2), (2048, 0, 1, 32767), (2049, 34737, 7, 10), (2054, 0, 1, 9102)], None, "WGS 84", "°"),
        ([(1024, 0, 1, 2), BASE, (2054, 0, 1, 9101)], 4326, None, None),
        ([(1024, 0, 1, 2), BASE, (3072, 0, 1, 32767)], 4326, None, "°"),
        ([(1024, 0, 1, 3), (2048, 0, 1, 4978), (2052, 0, 1, 9001)], 4978, None, "m"),
        ([(1024, 0, 1, 3), (2048, 0, 1, 32767), (2049, 34737, 7, 10)], None, "WGS 84", None),
        ([(1024, 0, 1, 1), (3072, 0, 1, 25832), (4096, 0, 1, 32767)], 25832, None, None),
        ([(4096, 0, 1, 5773)], None, None, None),
    ],
)
def test_a_base_is_not_the_system(
    rows: list[tuple[int, int, int, int]], epsg: int | None, name: str | None, unit: str | None
) -> None:
    """A projected system that the file defines by itself has neither the code nor the name of what it is based on."""
    texts = ifd.Entry(2, b"Site grid|WGS 84|\0")
    found = georeference(geo.pack({**TIED, 34735: keys(*rows), 34737: texts}), 10, 10)
    assert found is not None
    assert (found.epsg, found.name, found.unit) == (epsg, name, unit)


@pytest.mark.parametrize(
    "citation",
    [
        b"PCS Name = Mine TM|Datum = NAD83|",
        b'ESRI PE String = PROJCS["Mine TM",GEOGCS["GCS_NAD83"]]|',
        b"IMAGINE GeoTIFF Support\nProjection Name = Mine TM\nUnits = meters|",
    ],
)
def test_a_name_inside_a_citation(citation: bytes) -> None:
    rows = [(1024, 0, 1, 1), (3072, 0, 1, 32767), (3073, 34737, len(citation), 0)]
    found = georeference(geo.pack({**TIED, 34735: keys(*rows), 34737: ifd.Entry(2, citation + b"\0")}), 10, 10)
    assert found is not None
    assert found.name == "Mine TM"


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


@pytest.mark.parametrize(
    ("text", "microns"),
    [
        (b"Aperio Image Library v10.0.51|AppMag = 40|MPP = 0.2520|Left = 1", (0.252, 0.252)),
        (b'<OME><Pixels PhysicalSizeX="0.5" PhysicalSizeXUnit="\xc2\xb5m" PhysicalSizeY="0.25"/></OME>', (0.5, 0.25)),
    ],
)
def test_resolution_of_slides(text: bytes, microns: tuple[float, float]) -> None:
    found = resolution(None, directory(t270=ifd.Entry(2, text + b"\0"), t282=rational(1), t283=rational(1)))
    assert found is not None
    assert found.microns == microns


@pytest.mark.parametrize(
    "exif",
    [
        None,
        b"no EXIF",
        directory(t270=ifd.Entry(2, b"MPP = 0\0")),
        directory(t270=ifd.Entry(2, b"MPP = 1.2.3\0")),
        directory(t270=ifd.Entry(2, b'<OME PhysicalSizeX="1" PhysicalSizeXUnit="nm"\0')),
        directory(t282=rational(72), t283=rational(72), t296=ifd.Entry(3, b"\1\0")),
        directory(t282=rational(72, 0), t283=rational(72)),
    ],
)
def test_no_resolution(exif: bytes | None) -> None:
    assert resolution(None, exif) is None
