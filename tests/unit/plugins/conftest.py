"""Streams that tests of several plugins read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sgicodec


@pytest.fixture(scope="session")
def pyramid(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stream of 520×300 pixels in six tiles: three levels."""
    path = tmp_path_factory.mktemp("pyramid") / "pyramid.sgi"
    y, x = np.mgrid[:300, :520]
    pixels = np.stack([x % 256, y % 256, (x + y) // 5], axis=2).astype(np.uint8)
    sgicodec.imwrite(path, pixels, steps=3, tile=256, overview=False)
    return path


@pytest.fixture(scope="session")
def on_map(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stream of heights on a map, float32, 610×300 pixels of ten metres in six tiles, some without a value."""
    rasterio = pytest.importorskip("rasterio")
    folder = tmp_path_factory.mktemp("map")
    y, x = np.mgrid[:300, :610]
    heights = (200 + 50 * np.sin(x / 90) + y / 4).astype(np.float32)
    heights[:60, :90] = -9999
    profile = {"width": 610, "height": 300, "count": 1, "dtype": "float32", "nodata": -9999, "crs": "EPSG:32632"}
    place = rasterio.transform.from_origin(500000, 5400000, 10, 10)
    with rasterio.open(folder / "map.tif", "w", driver="GTiff", transform=place, **profile) as file:
        file.write(heights, 1)
    sgicodec.imwrite(folder / "map.sgi", folder / "map.tif", steps=4, tile=256)
    return folder / "map.sgi"
