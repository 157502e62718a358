"""What GDAL_METADATA says of bands, as GDAL writes it, and of damaged texts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tags import geo_of, text

from sgicodec import read
from sgicodec.metadata import geo
from sgicodec.metadata.gdal_items import BandFacts, band_facts

ITEM = '<Item name="DESCRIPTION" sample="0" role="description">red</Item>'


def test_what_gdal_writes(tmp_path: Path) -> None:
    rasterio = pytest.importorskip("rasterio")
    profile = {"count": 2, "height": 8, "width": 9, "dtype": "uint16", "photometric": "minisblack"}
    with rasterio.open(tmp_path / "a.tif", "w", driver="GTiff", **profile) as file:
        file.write(np.ones((2, 8, 9), np.uint16))
        file.descriptions, file.units = ("B4 «rouge»", None), ("", "K")
        file.scales, file.offsets = (1e-4, 1), (-0.1, 0)
        file.update_tags(1, wavelength="665 nm", STATISTICS_MEAN="5")
        file.update_tags(2, ns="SENSOR", gain="3")
        file.update_tags(of="all")
    found = band_facts(read(tmp_path / "a.tif").metadata.geo, 2)
    assert found == [BandFacts("B4 «rouge»", None, 1e-4, -0.1, {"wavelength": "665 nm"}), BandFacts(unit="K")]


@pytest.mark.parametrize(
    "stated",
    [
        "",
        "<GDALMetadata>" + ITEM,
        "<GDALMetadata>" + ITEM.replace('"0"', '"5"') + "</GDALMetadata>",
        "<GDALMetadata>" + ITEM.replace('"0"', '"-1"') + "</GDALMetadata>",
        "<GDALMetadata>" + ITEM.replace("description", "scale") + "</GDALMetadata>",
        "<!DOCTYPE a><GDALMetadata>" + ITEM + "</GDALMetadata>",
        "<GDALMetadata>" + ITEM + "</GDALMetadata>" + " " * (1 << 22),
    ],
)
def test_damaged_texts_say_nothing(stated: str) -> None:
    assert band_facts(geo_of({geo.GDAL_METADATA: text(stated)}), 2) == [BandFacts(), BandFacts()]
    assert (
        band_facts(geo_of({geo.GDAL_METADATA: text(f"<GDALMetadata>{ITEM}</GDALMetadata>")}), 2)[0].description == "red"
    )
    assert band_facts(None, 1) == [BandFacts()]
