from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tags import geo_of, text

from sgicodec.errors import UsageError
from sgicodec.metadata import geo
from sgicodec.metadata.layouts import SampleRange, range_text
from sgicodec.picture import Metadata, Picture, convert, from_unit, full_range, nodata_mask, to_unit


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
def test_every_integer_survives_the_unit_range(dtype: str) -> None:
    samples = np.arange(np.iinfo(dtype).max + 1, dtype=dtype).reshape(16, -1, 1)
    picture = Picture(samples, "gray", full_range(dtype))
    unit = to_unit(picture)
    assert unit.dtype == np.float32
    np.testing.assert_allclose(unit, samples.astype(np.float64) / np.iinfo(dtype).max, rtol=2e-7)
    assert (unit[0, 0, 0], unit[-1, -1, 0]) == (0.0, 1.0)
    np.testing.assert_array_equal(from_unit(unit, "gray", dtype).pixels, samples)


def test_ties_round_to_even_and_the_outside_is_clipped() -> None:
    unit = np.array([-0.5, 0.5 / 255, 1.5 / 255, 2.5 / 255, 1.5], np.float64).reshape(1, 5, 1)
    halves = unit.astype(np.float32) * np.float32(255)
    assert halves[0, 1:4, 0].tolist() == [0.5, 1.5, 2.5]
    assert from_unit(unit, "gray", "uint8").pixels.ravel().tolist() == [0, 0, 2, 2, 255]


@given(
    low=st.floats(-1e6, 1e6, width=32),
    span=st.floats(0.0625, 1e6, width=32),
    units=st.lists(st.floats(0, 1, width=32), min_size=1, max_size=8),
)
def test_floats_follow_their_range(low: float, span: float, units: list[float]) -> None:
    unit = np.array(units, np.float32).reshape(1, -1, 1)
    picture = from_unit(unit, "gray", "float32", (low, low + span))
    expected = low + unit.astype(np.float64) * span
    np.testing.assert_allclose(picture.pixels, expected, rtol=1e-6, atol=1e-6 * max(abs(low), span))
    np.testing.assert_allclose(to_unit(picture), unit, atol=4e-7 * max(abs(low), span) / span + 1e-6)


def test_a_stated_range_maps_colour_but_not_alpha() -> None:
    pixels = np.array([[[100, 65535], [300, 0], [500, 32768]]], np.uint16)
    picture = Picture(pixels, "gray+alpha", (100.0, 300.0))
    unit = to_unit(picture)
    np.testing.assert_allclose(unit[0], [[0, 1], [1, 0], [1, 32768 / 65535]], rtol=1e-6)
    back = from_unit(unit, "gray+alpha", "uint16", picture.sample_range).pixels
    np.testing.assert_array_equal(back[0], [[100, 65535], [300, 0], [300, 32768]])


def test_convert_between_depths() -> None:
    metadata = Metadata(icc=b"profile")
    picture = Picture(np.array([[[0], [1], [128], [255]]], np.uint8), "gray", (0.0, 255.0), metadata)
    deep = convert(picture, 16)
    assert deep.pixels.ravel().tolist() == [0, 257, 128 * 257, 65535]
    assert deep.metadata == metadata
    assert convert(deep, 8).pixels.tolist() == picture.pixels.tolist()
    assert convert(picture, 32).sample_range == (0.0, 1.0)
    np.testing.assert_allclose(convert(picture, 32).pixels.ravel(), [0, 1 / 255, 128 / 255, 1], rtol=1e-6)
    with pytest.raises(UsageError, match="8, 16 or 32"):
        convert(picture, 12)


@pytest.mark.parametrize(
    ("shape", "dtype", "channels", "sample_range", "message"),
    [
        ((2, 2), "uint8", "gray", (0, 255), "H, W, C"),
        ((0, 2, 1), "uint8", "gray", (0, 255), "not empty"),
        ((2, 2, 1), "float64", "gray", (0, 1), "float64"),
        ((2, 2, 3), "uint8", "rgba", (0, 255), "3 channels cannot be 'rgba'"),
        ((2, 2, 3), "uint8", "cmy", (0, 255), "3 channels cannot be 'cmy'"),
        ((2, 2, 1), "float32", "gray", (1.0, 1.0), "low before high"),
        ((2, 2, 1), "float32", "gray", (0.0, float("inf")), "low before high"),
        ((2, 2, 1), "float32", "gray", (float("nan"), 1.0), "low before high"),
        ((2, 2, 1), "float32", "gray", (-3e38, 3e38), "sample range"),
    ],
)
def test_contradictions_are_refused(
    shape: tuple[int, ...], dtype: str, channels: str, sample_range: tuple[float, float], message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        Picture(np.zeros(shape, dtype), channels, sample_range)


def _geo(nodata: bytes) -> Metadata:
    return Metadata(geo=geo_of({geo.GDAL_NODATA: text(nodata)}))


def test_pixels_without_data() -> None:
    pixels = np.array([[[7, 7, 7], [7, 7, 8], [0, 7, 7]]], np.uint8)
    picture = Picture(pixels, "rgb", (0.0, 255.0), _geo(b"7"))
    assert picture.nodata == 7.0
    assert nodata_mask(picture).tolist() == [[True, False, False]]
    assert nodata_mask(Picture(pixels, "rgb", (0.0, 255.0))).tolist() == [[False, False, False]]
    assert not nodata_mask(Picture(pixels, "rgb", (0.0, 255.0), _geo(b"300"))).any()


def test_no_data_may_be_no_number() -> None:
    picture = Picture(np.array([[[np.nan], [2.0], [4.0]]], np.float32), "gray", (2.0, 4.0), _geo(b"nan"))
    assert nodata_mask(picture).tolist() == [[True, False, False]]
    assert to_unit(picture).ravel().tolist() == [0.0, 0.0, 1.0]


def test_nodata_is_converted_with_its_samples() -> None:
    pixels = np.array([[[0], [1000], [65535]]], np.uint16)
    assert convert(Picture(pixels, "gray", (0.0, 65535.0), _geo(b"65535")), 8).nodata == 255.0
    assert convert(Picture(pixels.astype(np.float32), "gray", (0.0, 2000.0), _geo(b"1000")), 8).nodata == 128.0
    for gone in (b"-9999", b"nan"):
        assert convert(Picture(pixels.astype(np.float32), "gray", (0.0, 2000.0), _geo(gone)), 16).nodata is None
    assert convert(Picture(pixels, "gray", (0.0, 65535.0), _geo(b"0.5")), 8).metadata.geo is None


@pytest.mark.parametrize(
    ("sample_range", "said"),
    [
        ((0, 255), "0 to 255"),
        ((0.0, 0.123456789), "0 to 0.123457"),
        ((1e7, 1e7 + 1), "10000000 to 10000001"),
        ((4500000.0, 4500000.5), "4500000 to 4500000.5"),
        ((-1e30, 1e30), "-1e+30 to 1e+30"),
        (((0.0, 1e7), (1.0, 1e7 + 2)), "0 to 1, 10000000 to 10000002"),
    ],
)
def test_the_ends_of_a_range_differ(sample_range: SampleRange, said: str) -> None:
    assert range_text(sample_range) == said
