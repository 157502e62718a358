"""Cloud Optimized GeoTIFF, as GDAL reads it."""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import rasterio
import tifffile
from click.testing import CliRunner
from rasterio.transform import from_origin

import sgicodec
from sgicodec.cli.main import cli
from sgicodec.errors import MissingExtraError, PictureError
from sgicodec.plugins.cog import write_cog

PLACE = from_origin(500000, 5400000, 10, 10)


@pytest.fixture(scope="module")
def stream(tmp_path_factory: pytest.TempPathFactory) -> sgicodec.Stream:
    """Heights on a map, some of which were not measured."""
    path = tmp_path_factory.mktemp("map") / "map.tif"
    y, x = np.mgrid[:300, :610]
    heights = (200 + 50 * np.sin(x / 90) + y / 4).astype(np.float32)
    heights[:60, :90] = -9999
    profile = {"width": 610, "height": 300, "count": 1, "dtype": "float32", "nodata": -9999, "crs": "EPSG:32632"}
    with rasterio.open(path, "w", driver="GTiff", transform=PLACE, **profile) as file:
        file.write(heights, 1)
    return sgicodec.open(sgicodec.encode(path, steps=4, tile=256))


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


def test_directories_come_first_and_small_levels_before_large_ones(stream: sgicodec.Stream, tmp_path: Path) -> None:
    write_cog(stream, tmp_path / "a.tif")
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        directories = [page.offset for page in file.pages]
        tiles = [[at for at in page.dataoffsets if at] for page in file.pages]
        assert directories == sorted(directories)
        assert directories[-1] < min(map(min, tiles))
        assert all(max(small) < min(large) for large, small in pairwise(tiles))


def test_the_command_cuts_a_part(stream: sgicodec.Stream, tmp_path: Path) -> None:
    (tmp_path / "a.sgi").write_bytes(stream._source)
    arguments = ["decode", str(tmp_path / "a.sgi"), "--cog", "--region", "100,100,400,200", "--quiet"]
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code == 0, result.output
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.bounds == (501000, 5397000, 505000, 5399000)
        np.testing.assert_array_equal(file.read(1), stream.read((100, 100, 400, 200)))


def test_what_goes_wrong(stream: sgicodec.Stream, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(PictureError, match=r"none/a\.tif: "):
        write_cog(stream, tmp_path / "none" / "a.tif")
    monkeypatch.setitem(sys.modules, "rasterio", None)
    with pytest.raises(MissingExtraError, match=r"'sgicodec\[tiff\]'"):
        write_cog(stream, tmp_path / "a.tif")
    assert list(tmp_path.iterdir()) == []
