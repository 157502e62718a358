"""Streams in xarray, by the entry point."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rasterio
import xarray
from data_files import geotiff

import sgicodec


def test_a_level_is_a_dataset(pyramid: Path) -> None:
    with xarray.open_dataset(pyramid, engine="sgicodec", level=1) as data, sgicodec.open(pyramid) as stream:
        image = data["image"]
        assert (image.dims, image.shape, image.dtype) == (("y", "x", "band"), (150, 260, 3), np.uint8)
        whole = stream.read(size=(260, 150))
        np.testing.assert_allclose(image[100:110, 50:60].values.astype(int), whole[100:110, 50:60], atol=1)
        np.testing.assert_allclose(image.isel(y=[3, 120, 7], x=5).values.astype(int), whole[[3, 120, 7], 5], atol=1)
        np.testing.assert_array_equal(image.sel(x=slice(40, 60)).x, [41, 43, 45, 47, 49, 51, 53, 55, 57, 59])
        assert data.attrs == {"channels": "rgb"}


def test_levels_are_a_tree(on_map: Path) -> None:
    with xarray.open_datatree(on_map, engine="sgicodec") as tree, sgicodec.open(on_map) as stream:
        assert list(tree.children) == ["scale0", "scale1", "scale2"]
        for (width, height, _), level in zip(stream.levels, tree.children.values(), strict=True):
            image = level["image"]
            assert image.dims == ("y", "x")
            np.testing.assert_array_equal(image.values, stream.read(size=(width, height)))
            assert image.attrs == {"channels": "gray", "crs": "EPSG:32632", "_FillValue": -9999.0}
            across, down = 6100 / width, 3000 / height
            np.testing.assert_allclose(image.x, 500000 + across * (np.arange(width) + 0.5))
            np.testing.assert_allclose(image.y, 5400000 - down * (np.arange(height) + 0.5))
    groups = xarray.open_groups(on_map, engine="sgicodec")
    assert list(groups) == ["/", "/scale0", "/scale1", "/scale2"]


def scene(folder: Path) -> Path:
    """A stream of two bands of 16 bits that end in different places, of reflectance and of temperature."""
    ramp = (np.indices((40, 50)).sum(axis=0) * 30 + 1000).astype(np.uint16)
    bands = np.stack([ramp, 2 * ramp])
    bands[0, :9] = bands[1, 30:] = 0
    with rasterio.open(geotiff(folder / "a.tif", bands, nodata=0, photometric="minisblack", alpha="no"), "r+") as file:
        file.descriptions, file.units = ("B4 red", None), ("", "K")
        file.scales, file.offsets = (1e-4,) * 2, (-0.1,) * 2
    sgicodec.imwrite(folder / "a.sgi", folder / "a.tif", steps=3)
    return folder / "a.sgi"


def test_scale_and_nodata_are_decoded_by_conventions(tmp_path: Path) -> None:
    """As xarray decodes those of other formats, band by band."""
    with xarray.open_dataset(scene(tmp_path), engine="sgicodec") as data:
        attributes = data["image"].attrs
        assert attributes["long_name"] == ["B4 red", ""]
        assert attributes["units"] == ["", "K"]
        raw = data["image"].values.astype(float)
        assert [(raw[..., band] == 0).sum() for band in range(2)] == [9 * 50, 10 * 50]
        decoded = xarray.decode_cf(data)["image"].values
        np.testing.assert_allclose(decoded, np.where(raw == 0, np.nan, raw * 1e-4 - 0.1), rtol=1e-5)
