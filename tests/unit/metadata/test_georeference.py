"""Places and resolutions in words, from tags made by hand, and densities of pixels that files state."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import pytest
from image_files import by_pillow, packed
from tags import TIED, doubles, exif_of, geo_keys, geo_of, rational, shorts, text

from sgicodec import read
from sgicodec.metadata import density
from sgicodec.metadata.density import Density
from sgicodec.metadata.georeference import georeference, resolution
from sgicodec.metadata.png import chunk

UTM = "WGS 84 / UTM zone 33N|WGS 84|"

PROJECTED = [(1024, 0, 1, 1), (1025, 0, 1, 1), (1026, 34737, 22, 0), (3072, 0, 1, 32633), (3076, 0, 1, 9001)]
OBLONG = TIED | {33550: doubles(10, 20, 0)}


def test_a_projected_picture() -> None:
    found = georeference(geo_of({**OBLONG, 34735: geo_keys(*PROJECTED), 34737: text(UTM)}), 100, 50)
    assert found is not None
    assert (found.epsg, found.name, found.unit, found.rotated) == (32633, "WGS 84 / UTM zone 33N", "m", False)
    assert found.bounds == (5e5, 6e6 - 1000, 5e5 + 1000, 6e6)
    assert found.pixel_size == (10, 20)


def test_tie_points_may_be_centres() -> None:
    """PixelIsPoint: the tie point is the centre of the first pixel, so the picture reaches half a pixel further."""
    rows = [(1024, 0, 1, 2), (1025, 0, 1, 2), (2048, 0, 1, 4326)]
    found = georeference(geo_of({**OBLONG, 34735: geo_keys(*rows)}), 100, 50)
    assert found is not None
    assert (found.epsg, found.name, found.unit) == (4326, None, "°")
    assert found.bounds == (5e5 - 5, 6e6 + 10 - 1000, 5e5 + 995, 6e6 + 10)


@pytest.mark.parametrize(("unit", "microns"), [(2, 25400 / 50800), (3, 10000 / 50800)])
def test_resolution_of_tags(unit: int, microns: float) -> None:
    tags = {282: rational(50800), 283: rational(25400), 296: shorts(unit)}
    for found in (resolution(geo_of(tags), None), resolution(None, exif_of({**tags}))):
        assert found is not None
        assert found.microns == pytest.approx((microns, 2 * microns))
        assert found.stated == f"50800 × 25400 pixels per {'inch' if unit == 2 else 'cm'}"


def test_resolution_of_slides() -> None:
    aperio = text("Aperio Image Library v10.0.51|AppMag = 40|MPP = 0.2520|Left = 1")
    found = resolution(None, exif_of({270: aperio, 282: rational(1), 283: rational(1)}))
    assert found is not None
    assert found.microns == (0.252, 0.252)


PIXELS = np.full((9, 17, 3), 100, np.uint8)


def _jpeg(unit: int, across: int, down: int, **options: Any) -> bytes:
    data = by_pillow(PIXELS, "JPEG", **options)
    return data[:13] + struct.pack(">BHH", unit, across, down) + data[18:]


def _png(unit: int, across: int, down: int) -> bytes:
    data = by_pillow(PIXELS, "PNG")
    return data[:33] + chunk(b"pHYs", struct.pack(">IIB", across, down, unit)) + data[33:]


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (_jpeg(1, 300, 300), Density((300, 1), (300, 1), 2)),
        (_jpeg(1, 300, 150), Density((300, 1), (150, 1), 2)),
        (_jpeg(2, 118, 59), Density((118, 1), (59, 1), 3)),
        (_jpeg(0, 2, 1), Density((2, 1), (1, 1), 1)),
        (_png(1, 11811, 11811), Density((11811, 100), (11811, 100), 3)),
        (_png(0, 3, 4), Density((3, 1), (4, 1), 1)),
        *[(_jpeg(*values), None) for values in ((1, 72, 72), (2, 28, 28), (0, 1, 1), (1, 0, 0), (3, 5, 5))],
        *[(_png(*values), None) for values in ((1, 2835, 2835), (0, 1, 1), (1, 0, 5), (2, 5, 5))],
    ],
)
def test_what_a_file_states_is_kept(data: bytes, expected: Density | None) -> None:
    """But 72 pixels per inch, which are written where nothing was measured."""
    picture = read(data)
    assert density.density(picture.metadata.geo, None) == expected
    assert (picture.metadata.geo is None) == (expected is None)
    for format, tolerance in (("jpeg", 0.004), ("png", 0.0002), ("tiff", 0.0)):
        back = read(packed(picture, format)).metadata
        found = density.density(back.geo, back.exif)
        if expected is None:
            assert found is None
        else:
            assert found is not None
            unit = expected.unit if expected.unit == 1 else 2
            assert found.per(unit) == pytest.approx(expected.per(unit), rel=tolerance)
            assert expected.unit != 1 or found.unit == 1


@pytest.mark.parametrize(
    ("across", "down", "unit", "is_measured"),
    [
        (72, 72, 2, False),
        (28, 28, 3, False),
        (72, 71, 2, True),
        (96, 96, 2, True),
        (300, 300, 2, True),
        (72, 72, 3, True),
    ],
)
def test_72_pixels_per_inch_are_no_measurement(across: int, down: int, unit: int, is_measured: bool) -> None:
    tags = {282: rational(across), 283: rational(down), 296: shorts(unit)}
    blob, exif = geo_of(tags), exif_of({**tags})
    assert (resolution(blob, None) is not None) == (resolution(None, exif) is not None) == is_measured
