"""Densities of pixels that files state."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import pytest
from image_files import by_pillow, packed
from tags import exif_of, geo_of, rational, shorts

from sgicodec import read
from sgicodec.metadata import density, jpeg, png
from sgicodec.metadata.density import Density
from sgicodec.metadata.georeference import resolution
from sgicodec.metadata.png import chunk

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
        (73, 73, 2, True),
        (71, 71, 2, True),
        (96, 96, 2, True),
        (300, 300, 2, True),
        (72, 72, 3, True),
    ],
)
def test_72_pixels_per_inch_are_no_measurement(across: int, down: int, unit: int, is_measured: bool) -> None:
    tags = {282: rational(across), 283: rational(down), 296: shorts(unit)}
    blob, exif = geo_of(tags), exif_of({**tags})
    assert (resolution(blob, None) is not None) == (resolution(None, exif) is not None) == is_measured


@pytest.mark.parametrize(
    ("found", "jfif", "phys"),
    [
        (Density((100_000, 1), (100_000, 1), 3), False, True),  # 0.1 µm, more than JFIF's 16 bits
        (Density((1, 5), (1, 5), 3), False, True),  # half a pixel per inch
        (Density((1, 4000), (1, 4000), 3), False, False),
        (Density((181, 2), (181, 2), 2), True, True),  # 90.5 per inch, 91 in JFIF
        (Density((3, 2), (1, 1), 1), False, True),
    ],
)
def test_what_holds_a_density(found: Density, jfif: bool, phys: bool) -> None:
    assert (jpeg.density_field(found) is not None, png.density_field(found) is not None) == (jfif, phys)
