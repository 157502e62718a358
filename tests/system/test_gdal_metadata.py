"""What the driver of GDAL passes on besides samples: names, scales and units of bands, metadata, place, EXIF."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gdal_programs import NEEDS_GDAL, Run, info
from PIL import Image
from surgery import join, split

import sgicodec
from sgicodec.metadata import geo, ifd
from sgicodec.picture import Metadata, Picture

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


def test_the_picture_keeps_what_is_said_of_it(scene: Path, gdal: Run) -> None:
    source, stream = (info(gdal, path, "-mdd", "all") for path in (scene, scene.with_suffix(".sgi")))
    assert still_true(stream["metadata"]) == still_true(source["metadata"])
    assert {stream["metadata"][""]["TIFFTAG_IMAGEDESCRIPTION"], stream["metadata"]["ORDER"]["number"]} == {
        "fields",
        "7",
    }
    assert source["metadata"][""]["OVR_RESAMPLING_ALG"] == "NEAREST"
    assert stream["metadata"]["IMAGE_STRUCTURE"] == {
        "COMPRESSION": "SGICODEC",
        "COMPRESSION_REVERSIBILITY": "LOSSY",
        "INTERLEAVE": "PIXEL",
    }


def test_a_copy_keeps_it_too(scene: Path, gdal: Run, tmp_path: Path) -> None:
    gdal("gdal_translate", "-q", scene.with_suffix(".sgi"), tmp_path / "a.tif")
    copy, stream = info(gdal, tmp_path / "a.tif"), info(gdal, scene.with_suffix(".sgi"))
    for given, found in zip(stream["bands"], copy["bands"], strict=True):
        for key in ("description", "offset", "scale", "unit", "noDataValue", "colorInterpretation", "metadata"):
            assert found.get(key) == given.get(key), key


def test_statistics_of_the_source_are_left_out(gdal: Run, tmp_path: Path) -> None:
    """Of a stream that has them, which an encode of a file leaves behind."""
    names = ("STATISTICS_MEAN", "APPROX_STATISTICS_MEAN", "STATISTICS_VALID_PERCENT", "wavelength")
    items = "".join(f'<Item name="{name}" sample="0">5</Item>' for name in names)
    text = f"<GDALMetadata>{items}</GDALMetadata>".encode() + b"\0"
    metadata = Metadata(geo=geo.pack({geo.GDAL_METADATA: ifd.Entry(2, text)}))
    head, *others = split(sgicodec.encode(np.zeros((8, 9), np.uint8), steps=1))
    (tmp_path / "a.sgi").write_bytes(join([head, ("g", metadata.geo or b""), *others]))
    assert info(gdal, tmp_path / "a.sgi")["bands"][0]["metadata"] == {"": {"wavelength": "5"}}


def test_ground_control_points(gdal: Run, tmp_path: Path) -> None:
    rasterio = pytest.importorskip("rasterio")
    points = [
        rasterio.control.GroundControlPoint(row, column, 10 + column / 50, 50 - row / 39)
        for row, column in ((0, 0), (0, 50), (40, 0), (40, 50))
    ]
    profile = {"count": 1, "height": 40, "width": 50, "dtype": "uint8", "crs": "EPSG:4326", "gcps": points}
    with rasterio.open(tmp_path / "a.tif", "w", driver="GTiff", **profile) as file:
        file.write(np.full((1, 40, 50), 9, np.uint8))
    sgicodec.imwrite(tmp_path / "a.sgi", tmp_path / "a.tif", steps=1)
    source, stream = (info(gdal, tmp_path / name)["gcps"] for name in ("a.tif", "a.sgi"))
    assert stream["gcpList"] == source["gcpList"]
    assert len(stream["gcpList"]) == 4
    assert 'ID["EPSG",4326]' in stream["coordinateSystem"]["wkt"]


@pytest.mark.parametrize("order", ["<", ">"])
def test_exif(order: str, gdal: Run, tmp_path: Path) -> None:
    """As of a camera, in either order of bytes."""
    camera = Image.Exif()
    camera.endian = order
    camera[270], camera[271], camera[272] = "hill", "Acme", "Snap 2"
    camera.get_ifd(0x8769)[0x8827] = 200
    camera.get_ifd(0x8825).update({1: "N", 2: (47.0, 30.0, 0.0)})
    blob = camera.tobytes().removeprefix(b"Exif\0\0")
    assert blob[:2] == {"<": b"II", ">": b"MM"}[order]
    picture = Picture(np.zeros((8, 9, 3), np.uint8), "rgb", (0.0, 255.0), Metadata(exif=blob))
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(picture, steps=1))
    found = info(gdal, tmp_path / "a.sgi", "-mdd", "all")["metadata"]
    assert found[""] == {"TIFFTAG_IMAGEDESCRIPTION": "hill"}
    expected = {"EXIF_Make": "Acme", "EXIF_Model": "Snap 2", "EXIF_ISOSpeedRatings": "200"}
    place = {"EXIF_GPSLatitudeRef": "N", "EXIF_GPSLatitude": "(47) (30) (0)"}
    assert found["EXIF"] == expected | place
