"""The driver of GDAL, built against the headers that are there, in GDAL's own programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from data_files import GOLDEN
from gdal_programs import NEEDS_GDAL, Run, info, pixels

import sgicodec

pytestmark = NEEDS_GDAL


NAMES = (
    "rgb8",
    "rgb8-tiles",
    "rgba8",
    "gray8-alpha",
    "gray16",
    "float",
    "multi8",
    "multi16-bands",
    "float-tiles-exact",
)
TEXTURE = ("rgb8-texture", "rgb8-tiles-texture", "rgb8-any-texture", "rgba8-tiles-colours", "gray16-texture")
RESTORED = ("rgb8-restored", "rgb8-restored-psnr", "rgba8-tiles-restored", "gray16-restored")


@pytest.mark.parametrize("name", [*NAMES, *TEXTURE, *RESTORED])
def test_samples_are_those_of_the_decoder(name: str, gdal: Run, tmp_path: Path) -> None:
    path = GOLDEN / f"{name}.sgi"
    with sgicodec.open(path) as stream:
        np.testing.assert_array_equal(pixels(gdal, path, tmp_path / "a.tif"), stream.read())
        part = pixels(gdal, path, tmp_path / "b.tif", "-srcwin", 5, 9, 40, 30)
        np.testing.assert_array_equal(part, stream.read((5, 9, 40, 30)))
        found = info(gdal, path)
        assert (found["driverShortName"], found["size"]) == ("SGICODEC", [stream.width, stream.height])
        colours = {
            "rgb": ["Red", "Green", "Blue"],
            "rgba": ["Red", "Green", "Blue", "Alpha"],
            "gray": ["Gray"],
            "gray+alpha": ["Gray", "Alpha"],
        }
        bands = ["Gray", *["Undefined"] * (stream.header.spec.channels - 1)]  # as of a TIFF where nothing else is said
        expected = colours.get(stream.header.channels, bands)
        assert [band["colorInterpretation"] for band in found["bands"]] == expected


def test_place_and_nodata(on_map: Path, gdal: Run, tmp_path: Path) -> None:
    found = info(gdal, on_map)
    assert found["geoTransform"] == [500000, 10, 0, 5400000, 0, -10]
    assert 'ID["EPSG",32632]' in found["coordinateSystem"]["wkt"]
    assert found["bands"][0]["noDataValue"] == -9999
    assert found["bands"][0]["type"] == "Float32"
    cut = info(gdal, on_map, "-stats")["bands"][0]
    with sgicodec.open(on_map) as stream:
        values = stream.read()[stream.read() != -9999]
    assert (cut["minimum"], cut["maximum"]) == pytest.approx((values.min(), values.max()), abs=0.001)
    gdal("gdalwarp", "-q", "-t_srs", "EPSG:4326", on_map, tmp_path / "warped.tif")


def test_what_goes_wrong(gdal: Run, tmp_path: Path) -> None:
    data = bytearray((GOLDEN / "rgb8.sgi").read_bytes())
    (tmp_path / "cut.sgi").write_bytes(data[:-9])
    assert "cut.sgi: the file ends inside" in gdal("gdalinfo", tmp_path / "cut.sgi", fails=True).stderr
    data[len(data) // 2] ^= 255
    (tmp_path / "flipped.sgi").write_bytes(data)
    failed = gdal("gdal_translate", "-q", tmp_path / "flipped.sgi", tmp_path / "a.tif", fails=True)
    assert "the file is damaged" in failed.stderr
