"""Places and resolutions in words, from tags made by hand."""

from __future__ import annotations

import pytest
from tags import TIED, doubles, exif_of, geo_keys, geo_of, rational, shorts, text

from sgicodec.metadata.georeference import georeference, resolution

UTM = "WGS 84 / UTM zone 33N|WGS 84|"

PROJECTED = [(1024, 0, 1, 1), (1025, 0, 1, 1), (1026, 34737, 22, 0), (3072, 0, 1, 32633), (3076, 0, 1, 9001)]
OBLONG = TIED | {33550: doubles(10, 20, 0)}


def test_a_projected_picture() -> None:
    found = georeference(geo_of({**OBLONG, 34735: geo_keys(*PROJECTED), 34737: text(UTM)}), 100, 50)
    assert (found.epsg, found.name, found.unit, found.rotated) == (32633, "WGS 84 / UTM zone 33N", "m", False)
    assert found.bounds == (5e5, 6e6 - 1000, 5e5 + 1000, 6e6)
    assert found.pixel_size == (10, 20)


def test_tie_points_may_be_centres() -> None:
    """PixelIsPoint: the tie point is the centre of the first pixel, so the picture reaches half a pixel further."""
    rows = [(1024, 0, 1, 2), (1025, 0, 1, 2), (2048, 0, 1, 4326)]
    found = georeference(geo_of({**OBLONG, 34735: geo_keys(*rows)}), 100, 50)
    assert (found.epsg, found.name, found.unit) == (4326, None, "°")
    assert found.bounds == (5e5 - 5, 6e6 + 10 - 1000, 5e5 + 995, 6e6 + 10)


@pytest.mark.parametrize(("unit", "microns"), [(2, 25400 / 50800), (3, 10000 / 50800)])
def test_resolution_of_tags(unit: int, microns: float) -> None:
    tags = {282: rational(50800), 283: rational(25400), 296: shorts(unit)}
    for found in (resolution(geo_of(tags), None), resolution(None, exif_of({**tags}))):
        assert found.microns == pytest.approx((microns, 2 * microns))
        assert found.stated == f"50800 × 25400 pixels per {'inch' if unit == 2 else 'cm'}"


def test_resolution_of_slides() -> None:
    aperio = text("Aperio Image Library v10.0.51|AppMag = 40|MPP = 0.2520|Left = 1")
    assert resolution(None, exif_of({270: aperio, 282: rational(1), 283: rational(1)})).microns == (0.252, 0.252)
