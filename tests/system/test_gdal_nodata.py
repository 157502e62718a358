"""Nodata, masks and colours of bands in the driver of GDAL."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from data_files import geotiff
from gdal_programs import NEEDS_GDAL, Run, info, pixels

import sgicodec
from sgicodec.picture import Picture

pytestmark = NEEDS_GDAL

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
