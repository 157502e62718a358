"""Streams in xarray, by the entry point."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray
from range_server import served

import sgicodec
from sgicodec.errors import RegionError, StreamError
from sgicodec.plugins.xarray import SgiBackend

PICTURES = Path(__file__).parents[2] / "data" / "pictures"


def test_a_level_is_a_dataset(pyramid: Path) -> None:
    with xarray.open_dataset(pyramid, engine="sgicodec", level=1) as data, sgicodec.open(pyramid) as stream:
        image = data["image"]
        assert (image.dims, image.shape, image.dtype) == (("y", "x", "band"), (150, 260, 3), np.uint8)
        whole = stream.read(size=(260, 150))
        np.testing.assert_allclose(image[100:110, 50:60].values.astype(int), whole[100:110, 50:60], atol=1)
        np.testing.assert_allclose(image.isel(y=[3, 120, 7], x=5).values.astype(int), whole[[3, 120, 7], 5], atol=1)
        np.testing.assert_array_equal(image.sel(x=slice(40, 60)).x, [41, 43, 45, 47, 49, 51, 53, 55, 57, 59])
        assert data.attrs == {"channels": "rgb"}


def test_the_content_chooses_the_engine(pyramid: Path) -> None:
    with xarray.open_dataset(pyramid) as data:
        assert data["image"].shape == (300, 520, 3)
    backend = SgiBackend()
    assert backend.guess_can_open(str(pyramid))
    assert not backend.guess_can_open(str(PICTURES / "hopper.sgi"))
    assert not backend.guess_can_open(str(pyramid.parent / "none.sgi"))
    assert not backend.guess_can_open({})


def test_the_name_of_a_url_chooses_the_engine(pyramid: Path) -> None:
    backend = SgiBackend()
    assert backend.guess_can_open("s3://bucket/A%20B.SGI")
    assert backend.guess_can_open("https://example.org/a.sgi?signature=b/c")
    assert not backend.guess_can_open("https://example.org/a.nc?like=a.sgi")
    with served({"a.sgi": pyramid.read_bytes()}) as server:
        assert not server.parts
        with xarray.open_dataset(f"{server.url}/a.sgi") as data, sgicodec.open(pyramid) as stream:
            np.testing.assert_array_equal(data["image"].values, stream.read())


def test_chunks_are_those_of_dask(pyramid: Path) -> None:
    with xarray.open_dataset(pyramid, engine="sgicodec", chunks={"y": 200}) as data, sgicodec.open(pyramid) as stream:
        assert data["image"].chunks == ((200, 100), (520,), (3,))
        np.testing.assert_array_equal(data["image"].values, stream.read())
    with xarray.open_dataset(pyramid, engine="sgicodec", chunks={}) as data:
        assert data["image"].data.chunksize == (300, 520, 3)


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


def test_variables_can_be_left_out(pyramid: Path) -> None:
    with xarray.open_dataset(pyramid, engine="sgicodec", drop_variables="image") as data:
        assert list(data.variables) == ["y", "x"]


def test_what_goes_wrong(pyramid: Path) -> None:
    with pytest.raises(RegionError, match="level 3; there are 0 to 2"):
        xarray.open_dataset(pyramid, engine="sgicodec", level=3)
    with pytest.raises(StreamError, match="Silicon Graphics"):
        xarray.open_dataset(PICTURES / "hopper.sgi", engine="sgicodec")
