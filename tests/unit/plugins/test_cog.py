"""Cloud Optimized GeoTIFF, as GDAL reads it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import rasterio
from command import sgi
from rasterio.transform import from_origin

import sgicodec
from sgicodec.plugins.cog import write_cog

PLACE = from_origin(500000, 5400000, 10, 10)


@pytest.fixture
def stream(on_map: Path) -> Iterator[sgicodec.Stream]:
    with sgicodec.open(on_map) as found:
        yield found


def test_place_nodata_and_overviews(stream: sgicodec.Stream, tmp_path: Path) -> None:
    write_cog(stream, tmp_path / "a.tif")
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        assert (file.crs.to_epsg(), file.transform, file.nodata) == (32632, PLACE, -9999)
        assert file.overviews(1) == [2, 4]
        np.testing.assert_array_equal(file.read(1), stream.read())
    for level, (width, height, _) in enumerate(stream.levels[1:]):
        with rasterio.open(tmp_path / "a.tif", overview_level=level) as file:
            np.testing.assert_array_equal(file.read(1), stream.read(size=(width, height)))
    assert [path.name for path in tmp_path.iterdir()] == ["a.tif"]


def test_the_command_cuts_a_part(stream: sgicodec.Stream, on_map: Path, tmp_path: Path) -> None:
    result = sgi("decode", on_map, tmp_path / "a.tif", "--cog", "--region", "100,100,400,200", "--quiet")
    assert result.exit_code == 0, result.output
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.bounds == (501000, 5397000, 505000, 5399000)
        np.testing.assert_array_equal(file.read(1), stream.read((100, 100, 400, 200)))
