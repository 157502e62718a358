"""What the driver of GDAL passes on besides samples: names, scales and units of bands, metadata, place, EXIF."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gdal_programs import NEEDS_GDAL, Run, info

import sgicodec

pytestmark = NEEDS_GDAL

STALE = ("STATISTICS_", "OVR_RESAMPLING_ALG")


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A TIFF of four bands that says all that GDAL can say of them, and the stream beside it."""
    rasterio = pytest.importorskip("rasterio")
    path = tmp_path_factory.mktemp("scene") / "scene.tif"
    ramp = (np.indices((40, 50)).sum(axis=0) * 30 + 1000).astype(np.uint16)
    place = rasterio.transform.from_origin(500000, 5400000, 10, 10)
    profile = {"count": 4, "height": 40, "width": 50, "dtype": "uint16", "crs": "EPSG:32632", "transform": place}
    with rasterio.open(path, "w", driver="GTiff", photometric="minisblack", alpha="no", nodata=0, **profile) as file:
        file.write(np.stack([ramp, 2 * ramp, 3 * ramp, 4 * ramp]))
        colours = rasterio.enums.ColorInterp
        file.colorinterp = (colours.red, colours.green, colours.undefined, colours.blue)
        file.descriptions = ("B4 red", "B3 «vert»", None, "B2")
        file.scales, file.offsets, file.units = (1e-4, 2e-4, 1, 1), (-0.1, 0, 0, 5), ("reflectance", "", "K", "")
        file.update_tags(ACQUIRED="2024-06-01", OVR_RESAMPLING_ALG="NEAREST", TIFFTAG_IMAGEDESCRIPTION="fields")
        file.update_tags(ns="ORDER", number="7")
        file.update_tags(1, wavelength="665 nm", STATISTICS_MEAN="5", STATISTICS_VALID_PERCENT="1")
        file.update_tags(2, ns="SENSOR", gain="3")
    sgicodec.imwrite(path.with_suffix(".sgi"), path, steps=1)
    return path


def still_true(domains: dict[str, Any]) -> dict[str, Any]:
    """Metadata without what is said of the source's samples and storage."""
    found = {
        name: {key: value for key, value in items.items() if not key.startswith(STALE)}
        for name, items in domains.items()
        if name not in ("IMAGE_STRUCTURE", "DERIVED_SUBDATASETS")
    }
    return {name: items for name, items in found.items() if items}


def test_bands_keep_what_is_said_of_them(scene: Path, gdal: Run) -> None:
    source, stream = (info(gdal, path, "-mdd", "all") for path in (scene, scene.with_suffix(".sgi")))
    for given, found in zip(source["bands"], stream["bands"], strict=True):
        for key in ("description", "offset", "scale", "unit", "noDataValue", "colorInterpretation"):
            assert found.get(key) == given.get(key), key
        assert still_true(found.get("metadata", {})) == still_true(given.get("metadata", {}))
    assert stream["bands"][1]["description"] == "B3 «vert»"
    assert "STATISTICS_MEAN" in source["bands"][0]["metadata"][""]
    assert stream["bands"][0]["metadata"] == {"": {"wavelength": "665 nm"}}
    assert stream["bands"][1]["metadata"] == {"SENSOR": {"gain": "3"}}
