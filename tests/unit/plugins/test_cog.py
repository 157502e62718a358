"""Cloud Optimized GeoTIFF, as GDAL reads it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import rasterio
from command import done
from rasterio.transform import from_origin
from tags import geo_of, text

import sgicodec
from sgicodec.picture import Metadata, Picture
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
    done("decode", on_map, tmp_path / "a.tif", "--cog", "--region", "100,100,400,200", "--quiet")
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.bounds == (501000, 5397000, 505000, 5399000)
        np.testing.assert_array_equal(file.read(1), stream.read((100, 100, 400, 200)))


ITEM = '<Item name="A"{}>b</Item>'
OF_DATASET, OF_BAND = ITEM.format(' domain="IMAGERY"'), ITEM.format(' sample="0" domain="SENSOR"')


@pytest.mark.parametrize(
    ("items", "is_lost"),
    [
        ([OF_DATASET, OF_BAND, ITEM.format("")], False),
        ([ITEM.format(' sample="0"')], False),
        ([OF_DATASET, ITEM.format(' sample="0"')], True),
    ],
)
def test_items_in_domains(items: list[str], is_lost: bool, tmp_path: Path) -> None:
    """What GDAL does not copy is said."""
    blob = geo_of({42112: text(f"<GDALMetadata>{''.join(items)}</GDALMetadata>")})
    picture = Picture(np.zeros((16, 16, 1), np.uint8), "gray", (0.0, 255.0), Metadata(geo=blob))
    sgicodec.imwrite(tmp_path / "a.sgi", picture, steps=1)
    result = done("decode", tmp_path / "a.sgi", tmp_path / "a.tif", "--cog")
    lost = f"sgi: {tmp_path / 'a.tif'}: a COG does not hold its items of bands without a domain; --pyramid does\n"
    assert result.stderr == (lost if is_lost else "")
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.tags(ns="IMAGERY") == ({"A": "b"} if OF_DATASET in items else {})
        assert file.tags(1, ns="SENSOR") == ({"A": "b"} if OF_BAND in items else {})
        assert ("A" in file.tags(), "A" in file.tags(1)) == (ITEM.format("") in items, len(items) == 1)
