"""Nodata, masks and colours of bands in the driver of GDAL."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from gdal_programs import NEEDS_GDAL, Run, info, pixels

import sgicodec
from sgicodec.metadata import geo, ifd
from sgicodec.picture import Metadata, Picture

pytestmark = NEEDS_GDAL

WIDTH, HEIGHT = 600, 400
QUICK = {"steps": 2, "tile": 256, "rdoq": False}
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


def tif_of(path: Path, bands: np.ndarray, nodata: float | None, **profile: object) -> Path:
    rasterio = pytest.importorskip("rasterio")
    shape = {"count": len(bands), "height": bands.shape[1], "width": bands.shape[2], "dtype": bands.dtype}
    place = rasterio.transform.from_origin(500000, 5400000, 10, 10)
    profile = {"nodata": nodata, "photometric": "minisblack", "alpha": "unspecified"} | profile
    with rasterio.open(path, "w", driver="GTiff", transform=place, crs="EPSG:32632", **shape, **profile) as file:
        file.write(bands)
    return path


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
    source = tif_of(tmp_path / "a.tif", bands, nodata)
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


@pytest.mark.parametrize(("dtype", "nodata"), KINDS)
def test_as_many_samples_are_valid(dtype: str, nodata: float, gdal: Run, tmp_path: Path) -> None:
    source = tif_of(tmp_path / "a.tif", bare_bands(dtype, nodata), nodata)
    sgicodec.imwrite(tmp_path / "a.sgi", source, **QUICK)
    valid = [
        [band["metadata"][""]["STATISTICS_VALID_PERCENT"] for band in info(gdal, path, "-stats")["bands"]]
        for path in (source, tmp_path / "a.sgi")
    ]
    assert valid[0] == valid[1]
    assert valid[0][0] != valid[0][1]


@pytest.mark.parametrize(("dtype", "nodata", "told"), [("uint16", 7, 7), ("float32", np.nan, "NaN")])
def test_the_header_alone_says_nodata(dtype: str, nodata: float, told: object, gdal: Run, tmp_path: Path) -> None:
    samples = np.full((40, 50, 2), 9, dtype)
    samples[:9, :, 1] = nodata
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(samples, channels="multi", nodata=nodata, steps=1))
    assert [band["noDataValue"] for band in info(gdal, tmp_path / "a.sgi")["bands"]] == [told, told]


def test_alpha_is_no_nodata(gdal: Run, tmp_path: Path) -> None:
    """Of a picture with alpha and nodata the colours have nodata, alpha has none."""
    samples = np.full((40, 50, 4), 90, np.uint8)
    samples[:9, :, :3] = samples[:5, :, 3] = 0
    picture = Picture(samples, "rgba", (0.0, 255.0), blank=0.0)
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(picture, steps=1))
    bands = info(gdal, tmp_path / "a.sgi")["bands"]
    assert [band.get("noDataValue") for band in bands] == [0, 0, 0, None]


def test_alpha_is_the_mask(gdal: Run, tmp_path: Path) -> None:
    for layout, count in {"gray+alpha": 2, "rgba": 4}.items():
        samples = np.full((40, 50, count), 90, np.uint8)
        (tmp_path / "a.sgi").write_bytes(sgicodec.encode(samples, channels=layout, steps=1))
        bands = info(gdal, tmp_path / "a.sgi")["bands"]
        assert [band["mask"]["flags"] for band in bands[:-1]] == [["PER_DATASET", "ALPHA"]] * (count - 1)
        assert bands[-1]["colorInterpretation"] == "Alpha"


@pytest.mark.parametrize("count", [2, 4, 5])
def test_bands_without_a_meaning_are_no_alpha(count: int, gdal: Run, tmp_path: Path) -> None:
    """Near infrared is none; bands are called as in the source."""
    bands = np.tile(np.arange(60, dtype=np.uint16), (count, 50, 1)) + 50
    source = tif_of(tmp_path / "a.tif", bands, None)
    sgicodec.imwrite(tmp_path / "a.sgi", source, steps=1)
    told = [
        [band["colorInterpretation"] for band in info(gdal, path)["bands"]] for path in (source, tmp_path / "a.sgi")
    ]
    assert told[0] == told[1] == ["Gray", *["Undefined"] * (count - 1)]


def test_damaged_tags_are_passed_over(gdal: Run, tmp_path: Path) -> None:
    """Directories that lie elsewhere, have too many rows, or rows that describe another picture."""
    rows = b"".join(bytes.fromhex(f"{tag} 0400 01000000 ffffff7f") for tag in ("0001", "0101", "1101", "1501", "1701"))
    blobs = [b"II*\0\xff\xff\xff\xff", b"II*\0\x08\0\0\0\xff\xff", b"II*\0\x08\0\0\0\x05\0" + rows + bytes(4), b"MM\0*"]
    for blob in blobs:
        picture = Picture(np.zeros((8, 9, 3), np.uint8), "multi", (0.0, 255.0), Metadata(geo=blob, exif=blob))
        (tmp_path / "a.sgi").write_bytes(sgicodec.encode(picture, steps=1))
        assert info(gdal, tmp_path / "a.sgi")["size"] == [9, 8]


def test_alpha_that_gdal_denies_is_a_band(gdal: Run, tmp_path: Path) -> None:
    """A stream whose fourth channel the file declared as alpha, while GDAL's metadata call it undefined."""
    item = '<Item name="COLORINTERP" sample="3" role="colorinterp">Undefined</Item>'
    text = f"<GDALMetadata>{item}</GDALMetadata>".encode() + b"\0"
    metadata = Metadata(geo=geo.pack({geo.GDAL_METADATA: ifd.Entry(2, text)}))
    picture = Picture(np.full((40, 50, 4), 90, np.uint8), "rgba", (0.0, 255.0), metadata)
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(picture, steps=1))
    bands = info(gdal, tmp_path / "a.sgi")["bands"]
    assert [band["colorInterpretation"] for band in bands] == ["Red", "Green", "Blue", "Undefined"]
    assert not any("mask" in band for band in bands)


@pytest.mark.parametrize("tile", [0, 256])
def test_a_scene_that_is_valid_everywhere_stays_so(tile: int, gdal: Run, tmp_path: Path) -> None:
    """In one tile and in several, near infrared that is declared as alpha and called undefined by GDAL."""
    rasterio = pytest.importorskip("rasterio")
    noise = np.random.default_rng(8).integers(1, 10, (4, HEIGHT, WIDTH)).astype(np.uint8)
    source = tif_of(tmp_path / "a.tif", noise, 0, photometric="rgb", alpha="unspecified")
    with rasterio.open(source, "r+") as file:
        file.colorinterp = [rasterio.enums.ColorInterp.undefined] * 4
    sgicodec.imwrite(tmp_path / "a.sgi", source, quality=10, **(QUICK | {"tile": tile}))
    found, given = (info(gdal, path, "-stats")["bands"] for path in (tmp_path / "a.sgi", source))
    assert [band["colorInterpretation"] for band in found] == [band["colorInterpretation"] for band in given]
    assert not any(band["colorInterpretation"] == "Alpha" for band in found)
    assert [float(band["metadata"][""]["STATISTICS_VALID_PERCENT"]) for band in found] == [100] * 4
    for options in ([], ["-outsize", 30, 20], ["-r", "average", "-outsize", 180, 120], ["-oo", "EXACT=YES"]):
        assert pixels(gdal, tmp_path / "a.sgi", tmp_path / "b.tif", *options).min() > 0
