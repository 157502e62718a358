"""An analyst's first minutes: a photograph of four bands becomes a stream, is warped, measured and handed on."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import rasterio
from gdal_programs import NEEDS_GDAL, Run, info, pixels
from library import ROOT

from benchmarks.indices import difference, ndvi

pytestmark = NEEDS_GDAL

NAIP = ROOT / "tests" / "data" / "naip.tif"
SGI = Path(sys.executable).with_name("sgi")


def test_translate_warp_and_hand_on(gdal: Run, tmp_path: Path) -> None:
    stream, cog, warped = tmp_path / "naip.sgi", tmp_path / "naip-cog.tif", tmp_path / "warped.tif"
    options = ("-co", "QUALITY=70", "-co", "EFFORT=2", "-co", f"PROGRAM={SGI}")
    gdal("gdal_translate", "-q", "-of", "SGICODEC", NAIP, stream, *options)
    assert stream.stat().st_size < NAIP.stat().st_size / 8
    assert info(gdal, stream)["geoTransform"] == info(gdal, NAIP)["geoTransform"]
    index = ndvi(pixels(gdal, stream, tmp_path / "a.tif"), 0, 3)
    off = difference(index, ndvi(pixels(gdal, NAIP, tmp_path / "b.tif"), 0, 3))
    assert off.rms < 0.07
    assert abs(off.bias) < 0.005

    gdal("gdalwarp", "-q", "-t_srs", "EPSG:4326", "-r", "bilinear", stream, warped)
    gdal("gdalwarp", "-q", "-t_srs", "EPSG:4326", "-r", "bilinear", NAIP, tmp_path / "expected.tif")
    with rasterio.open(warped) as found, rasterio.open(tmp_path / "expected.tif") as expected:
        assert found.transform == expected.transform
        inside = expected.read().any(axis=0)
        assert np.abs(found.read().astype(int) - expected.read())[:, inside].mean() < 6

    subprocess.run([SGI, "decode", stream, cog, "--cog", "--compress", "lerc:2", "--quiet"], check=True)
    with rasterio.open(cog) as file:
        assert (file.tags(ns="IMAGE_STRUCTURE")["LAYOUT"], file.crs.to_epsg()) == ("COG", 26914)


def test_a_lossless_copy_keeps_every_index(gdal: Run, tmp_path: Path) -> None:
    stream = tmp_path / "naip.sgi"
    options = ("-co", "LOSSLESS=YES", "-co", "EFFORT=1", "-co", f"PROGRAM={SGI}")
    gdal("gdal_translate", "-q", "-of", "SGICODEC", NAIP, stream, *options)
    assert stream.stat().st_size < 0.75 * NAIP.stat().st_size
    np.testing.assert_array_equal(pixels(gdal, stream, tmp_path / "a.tif"), pixels(gdal, NAIP, tmp_path / "b.tif"))
