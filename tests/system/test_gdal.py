"""The driver of GDAL, built against the headers that are there, in its own programs: samples, what it says, nodata."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from data_files import GOLDEN, geotiff
from gdal_programs import NEEDS_GDAL, Run, info, pixels

import sgicodec
from sgicodec.picture import Picture

pytestmark = NEEDS_GDAL


NAMES = (
    "rgb8",
    "rgb8-tiles",
    "rgba8",
    "gray8-alpha",
    "gray16",
    "float",
    "multi8",
    "multi16-bands",
    "float-tiles-exact",
)
TEXTURE = ("rgb8-texture", "rgb8-tiles-texture", "rgb8-any-texture", "rgba8-tiles-colours", "gray16-texture")
RESTORED = ("rgb8-restored", "rgb8-restored-psnr", "rgba8-tiles-restored", "gray16-restored")


@pytest.mark.parametrize("name", [*NAMES, *TEXTURE, *RESTORED])
def test_samples_are_those_of_the_decoder(name: str, gdal: Run, tmp_path: Path) -> None:
    path = GOLDEN / f"{name}.sgi"
    with sgicodec.open(path) as stream:
        np.testing.assert_array_equal(pixels(gdal, path, tmp_path / "a.tif"), stream.read())
        part = pixels(gdal, path, tmp_path / "b.tif", "-srcwin", 5, 9, 40, 30)
        np.testing.assert_array_equal(part, stream.read((5, 9, 40, 30)))
        found = info(gdal, path)
        assert (found["driverShortName"], found["size"]) == ("SGICODEC", [stream.width, stream.height])
        colours = {
            "rgb": ["Red", "Green", "Blue"],
            "rgba": ["Red", "Green", "Blue", "Alpha"],
            "gray": ["Gray"],
            "gray+alpha": ["Gray", "Alpha"],
        }
        bands = ["Gray", *["Undefined"] * (stream.header.spec.channels - 1)]  # as of a TIFF where nothing else is said
        expected = colours.get(stream.header.channels, bands)
        assert [band["colorInterpretation"] for band in found["bands"]] == expected


def test_place_and_nodata(on_map: Path, gdal: Run, tmp_path: Path) -> None:
    found = info(gdal, on_map)
    assert found["geoTransform"] == [500000, 10, 0, 5400000, 0, -10]
    assert 'ID["EPSG",32632]' in found["coordinateSystem"]["wkt"]
    assert found["bands"][0]["noDataValue"] == -9999
    assert found["bands"][0]["type"] == "Float32"
    cut = info(gdal, on_map, "-stats")["bands"][0]
    values = sgicodec.imread(on_map)
    values = values[values != -9999]
    assert (cut["minimum"], cut["maximum"]) == pytest.approx((values.min(), values.max()), abs=0.001)
    gdal("gdalwarp", "-q", "-t_srs", "EPSG:4326", on_map, tmp_path / "warped.tif")


def test_what_goes_wrong(gdal: Run, tmp_path: Path) -> None:
    data = bytearray((GOLDEN / "rgb8.sgi").read_bytes())
    (tmp_path / "cut.sgi").write_bytes(data[:-9])
    assert "cut.sgi: the file ends inside" in gdal("gdalinfo", tmp_path / "cut.sgi", fails=True).stderr
    data[len(data) // 2] ^= 255
    (tmp_path / "flipped.sgi").write_bytes(data)
    failed = gdal("gdal_translate", "-q", tmp_path / "flipped.sgi", tmp_path / "a.tif", fails=True)
    assert "the file is damaged" in failed.stderr


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


WIDTH, HEIGHT = 600, 400
QUICK = {"steps": 2, "tile": 256, "rdoq": False}
BANDS = {"photometric": "minisblack", "alpha": "unspecified"}
KINDS = [
    ("uint8", 0.0),
    ("uint8", 255.0),
    ("uint16", 0.0),
    ("uint16", 65535.0),
    ("float32", -9999.0),
    ("float32", np.nan),
]


def bare_bands(dtype: str, nodata: float) -> np.ndarray:
    """Bands [2, H, W] of unlike range that end in different places; valid samples come as near to nodata as can be."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    ramp = np.stack([1 + (x + y) // 5, 40 + y // 2])
    bands = ramp.astype(dtype) if nodata <= 0 or dtype == "float32" else (nodata - ramp).astype(dtype)
    if nodata == -9999:
        bands[0] = -9998.5 + bands[0] / 100
    bands[0, :90, :200] = bands[1, 150:, 350:] = bands[1, 30:33, 40:47] = nodata
    return bands


def is_nodata(samples: np.ndarray, nodata: float) -> np.ndarray:
    return np.isnan(samples) if math.isnan(nodata) else samples == nodata


def shares(empty: np.ndarray, width: int, height: int, margin: int) -> np.ndarray:
    """The share of empty pixels in what each of so many output pixels shows, and around it."""
    sums = np.pad(empty.cumsum(0).cumsum(1), ((1, 0), (1, 0)))

    def edges(count: int, size: int) -> tuple[np.ndarray, np.ndarray]:
        at = np.arange(count + 1) * size / count
        return np.clip(np.floor(at[:-1]) - margin, 0, size).astype(int), np.clip(
            np.ceil(at[1:]) + margin, 0, size
        ).astype(int)

    (top, bottom), (left, right) = edges(height, empty.shape[0]), edges(width, empty.shape[1])
    inside = sums[bottom][:, right] - sums[top][:, right] - sums[bottom][:, left] + sums[top][:, left]
    return inside / np.outer(bottom - top, right - left)


@pytest.mark.parametrize(("dtype", "nodata"), KINDS)
def test_each_band_has_its_own_nodata(dtype: str, nodata: float, gdal: Run, tmp_path: Path) -> None:
    """At full size exactly its own; at any scale none where all around is valid, and nothing else where nothing is."""
    bands = bare_bands(dtype, nodata)
    source = geotiff(tmp_path / "a.tif", bands, nodata=nodata, **BANDS)
    sgicodec.imwrite(tmp_path / "a.sgi", source, **QUICK)
    whole = pixels(gdal, tmp_path / "a.sgi", tmp_path / "whole.tif")
    np.testing.assert_array_equal(is_nodata(whole, nodata), is_nodata(bands, nodata).transpose(1, 2, 0))
    for turn, options in enumerate((["-outsize", 217, 161], ["-outsize", 1000, 700], ["-oo", "OVERVIEW_LEVEL=0"])):
        shown = pixels(gdal, tmp_path / "a.sgi", tmp_path / f"{turn}.tif", *options)
        for band in range(2):
            share = shares(is_nodata(bands[band], nodata), shown.shape[1], shown.shape[0], 4)
            found = is_nodata(shown[..., band], nodata)
            assert not found[share == 0].any()
            assert found[share == 1].all()
            assert (share == 1).any()


def test_alpha_is_no_nodata(gdal: Run, tmp_path: Path) -> None:
    """Of a picture with alpha and nodata the colours have nodata, alpha has none."""
    samples = np.full((40, 50, 4), 90, np.uint8)
    samples[:9, :, :3] = samples[:5, :, 3] = 0
    picture = Picture(samples, "rgba", (0.0, 255.0), blank=0.0)
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(picture, steps=1))
    bands = info(gdal, tmp_path / "a.sgi")["bands"]
    assert [band.get("noDataValue") for band in bands] == [0, 0, 0, None]


@pytest.mark.parametrize(("values", "said"), [((1, 2), "1, 2"), ((1, None), "1, none"), ((None, 2), "2, none")])
def test_bands_of_unlike_nodata_are_refused(
    values: tuple[float | None, ...], said: str, gdal: Run, tmp_path: Path
) -> None:
    """GeoTIFF has one value for all: valid samples of the other bands would be nodata."""
    source, virtual = geotiff(tmp_path / "a.tif", bare_bands("uint16", 0), **BANDS), tmp_path / "a.vrt"
    gdal("gdal_translate", "-q", "-of", "VRT", source, virtual)
    *bands, end = virtual.read_text().split("</VRTRasterBand>")
    stated = ["" if value is None else f"<NoDataValue>{value}</NoDataValue>" for value in values]
    text = "".join(f"{band}{own}</VRTRasterBand>" for band, own in zip(bands, stated, strict=True))
    virtual.write_text(text + end)
    failed = gdal("gdal_translate", "-q", "-of", "SGICODEC", virtual, tmp_path / "a.sgi", fails=True)
    assert f"nodata of bands differs ({said})" in failed.stderr
    assert len(failed.stderr.splitlines()) == 1
    assert not (tmp_path / "a.sgi").exists()
