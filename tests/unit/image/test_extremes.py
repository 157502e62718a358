from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.errors import PictureError, UsageError
from sgicodec.image import open_source, read, write
from sgicodec.image.extremes import Extremes
from sgicodec.metadata import geo, ifd
from sgicodec.picture import Metadata, Picture, from_unit, to_unit

SAMPLES = st.lists(st.floats(-1e6, 1e6, width=32), min_size=2, max_size=20)


@given(samples=SAMPLES, parts=st.integers(1, 5), holes=st.sampled_from([None, -9999.0, float("nan")]))
def test_parts_give_the_extremes_of_the_whole(samples: list[float], parts: int, holes: float | None) -> None:
    found = Extremes("gray", holes)
    kept = [value for value in samples if value != holes]
    mixed = kept if holes is None else [*kept, holes, holes]
    for part in np.array_split(np.array(mixed, np.float32), parts):
        found.add(part.reshape(1, -1, 1))
    low, high = found.range()
    if not kept:
        assert (low, high) == (0.0, 1.0)
    else:
        assert low == min(kept)
        assert high == max(kept) if min(kept) < max(kept) else high > low


def test_alpha_does_not_count() -> None:
    found = Extremes("rgba", None)
    found.add(np.array([[[2.0, 3.0, 4.0, 99.0]]], np.float32))
    assert found.range() == (2.0, 4.0)


@pytest.mark.parametrize("value", [np.inf, -np.inf])
def test_infinite_samples(value: float) -> None:
    pixels = np.array([[[value], [1.0]]], np.float32)
    with pytest.raises(PictureError, match="infinite"):
        Extremes("gray", None).add(pixels)
    found = Extremes("gray", value)
    found.add(pixels)
    assert found.range() == (1.0, 2.0)


def test_extremes_farther_apart_than_floats_tell() -> None:
    found = Extremes("gray", None)
    found.add(np.array([-1.7e38, 1.8e38], np.float32).reshape(1, 2, 1))
    with pytest.raises(PictureError, match="farther apart than floats"):
        found.range()


def test_float_range_found_or_stated() -> None:
    samples = np.array([[-2.0, 0.5], [6.0, 1.0]], "<f4")
    data = b"Pf\n2 2\n-1\n" + samples[::-1].tobytes()
    found = read(data)
    assert found.pixels[..., 0].tolist() == samples.tolist()
    assert found.sample_range == (-2.0, 6.0)
    stated = read(data, sample_range=(0.0, 1.0))
    assert stated.sample_range == (0.0, 1.0)
    assert to_unit(stated)[..., 0].tolist() == [[0.0, 0.5], [1.0, 1.0]]
    back = from_unit(to_unit(found), "gray", "float32", found.sample_range)
    np.testing.assert_allclose(back.pixels, found.pixels, atol=1e-6)
    with pytest.raises(UsageError, match="low before high"):
        read(data, sample_range=(1.0, 0.0))


def test_flat_floats_have_a_range() -> None:
    assert read(b"Pf\n1 1\n-1\n" + struct.pack("<f", 5.0)).sample_range == (5.0, 10.0)


@pytest.mark.parametrize("value", [float("inf"), float("-inf"), float("nan")])
def test_samples_that_are_not_finite(value: float) -> None:
    data = b"Pf\n2 1\n-1\n" + struct.pack("<ff", 0.0, value)
    with pytest.raises(PictureError, match=r"not a number|infinite"):
        read(data)
    if np.isnan(value):
        with pytest.raises(PictureError, match="not a number"):
            read(data, sample_range=(0.0, 1.0))
    else:
        assert to_unit(read(data, sample_range=(0.0, 1.0))).ravel().tolist() == [0.0, float(value > 0)]


@pytest.mark.parametrize("nodata", [b"-9999", b"nan"])
def test_samples_without_data_are_outside_the_range(tmp_path: Path, nodata: bytes) -> None:
    pixels = np.array([[[float(nodata)], [2.0], [4.0]]], np.float32)
    metadata = Metadata(geo=geo.pack({geo.GDAL_NODATA: ifd.Entry(2, nodata + b"\0")}))
    write(Picture(pixels, "gray", (2.0, 4.0), metadata), tmp_path / "x.tif")
    for picture in (read(tmp_path / "x.tif"), open_source(tmp_path / "x.tif").read(0, 0, 3, 1)):
        np.testing.assert_array_equal(picture.pixels, pixels)
        assert picture.sample_range == (2.0, 4.0)
    pixels[0, 1] = np.nan
    write(Picture(pixels, "gray", (2.0, 4.0), metadata), tmp_path / "x.tif")
    if nodata == b"-9999":
        with pytest.raises(PictureError, match="not a number"):
            read(tmp_path / "x.tif")
