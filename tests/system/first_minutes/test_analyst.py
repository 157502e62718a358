"""The first minutes of somebody who works with maps: a scene in, itself, parts and an index out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import rasterio
from data_files import DATA
from gdal_programs import NEEDS_GDAL, Run, info
from newcomer import Newcomer

pytestmark = pytest.mark.slow

NDVI = """
import rasterio
bands = [rasterio.open(name).read(masked=True).astype(float) for name in ("scene.tif", "back.tif")]
true, found = ((infrared - red) / (infrared + red) for red, _, _, infrared in bands)
error = found - true
squares = error.filled(float("nan")).reshape(32, 8, 32, 8).mean((1, 3))
print((error**2).mean() ** 0.5, (squares[squares == squares] ** 2).mean() ** 0.5, error.count())
"""


@pytest.fixture
def analyst(newcomer: Newcomer) -> Newcomer:
    """Has a NAIP photograph whose fourth band, infrared, is declared as alpha, and a corner that was not flown over."""
    with rasterio.open(DATA / "naip.tif") as source:
        samples, profile = np.maximum(source.read(), 1), source.profile
    samples[:, :64, :80] = 0
    with rasterio.open(newcomer.home / "scene.tif", "w", **profile | {"nodata": 0}) as target:
        target.write(samples)
    newcomer.install("sgicodec[tiff]")
    return newcomer


def test_a_scene_and_back(analyst: Newcomer, reached: Callable[[str], None]) -> None:
    analyst.run("sgi", "encode", "scene.tif", "-q", "70", "--alpha", "band")  # as it says where this is left out
    analyst.run("sgi", "decode", "scene.sgi", "back.tif")
    rms, of_squares, count = map(float, analyst.run("python", "-c", NDVI).split())
    reached(f"NDVI of a decoded scene, {rms:.3f} off (rms), {of_squares:.3f} over 40 m,")
    assert of_squares < 0.02  # docs/maps.md: 0.007
    assert count == 256 * 256 - 64 * 80
    analyst.run("sgi", "decode", "scene.sgi", "part.tif", "--region", "32,48,128,96")
    analyst.run("sgi", "decode", "scene.sgi", "cog.tif", "--cog")
    analyst.run("rio", "warp", "cog.tif", "degrees.tif", "--dst-crs", "EPSG:4326")
    reached("a region, a COG, and the COG warped to degrees")
    with rasterio.open(analyst.home / "scene.tif") as source, rasterio.open(analyst.home / "back.tif") as back:
        assert (back.crs, back.transform, back.nodata) == (source.crs, source.transform, 0)
        np.testing.assert_array_equal(back.read() == 0, source.read() == 0)
        with rasterio.open(analyst.home / "part.tif") as part:
            assert (part.crs, part.xy(0, 0), part.nodata) == (source.crs, source.xy(48, 32), 0)
            np.testing.assert_array_equal(part.read(), back.read()[:, 48:144, 32:160])
        with rasterio.open(analyst.home / "degrees.tif") as warped:
            assert (warped.count, warped.nodata, warped.crs.to_epsg()) == (4, 0, 4326)
            assert (warped.read()[:, warped.height // 2, warped.width // 2] > 0).all()


@pytest.mark.parametrize("_", [pytest.param(None, marks=NEEDS_GDAL)])
def test_programs_of_gdal(_: None, analyst: Newcomer, gdal: Run) -> None:
    """With the driver that they load."""
    analyst.run("sgi", "encode", "scene.tif", "-e", "1", "--alpha", "band")
    stream, out = (analyst.home / name for name in ("scene.sgi", "out.tif"))
    gdal("gdalwarp", "-q", "-t_srs", "EPSG:4326", stream, out)
    assert [band["noDataValue"] for band in info(gdal, out)["bands"]] == [0] * 4
