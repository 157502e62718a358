"""Samples of every depth: quality means the same at any range, and no sample is lost in silence."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from command import done
from data_files import crop

import sgicodec
from sgicodec.picture import Picture

PHOTO = crop("kodim23", np.s_[100:292, 180:372]).pixels
UNIT = PHOTO / 255.0


def decibels(original: np.ndarray, decoded: np.ndarray) -> float:
    """PSNR of the range in use."""
    span = float(original.max()) - float(original.min())
    return 10 * np.log10(span**2 / np.mean((original.astype(float) - decoded) ** 2))


def stream_of(pixels: np.ndarray, **settings: Any) -> sgicodec.Stream:
    settings = {"quality": 60, "effort": 1, "tune": "psnr"} | settings
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return sgicodec.open(sgicodec.encode(pixels, **settings))


def scaled(top: float, low: float = 0.0, dtype: str = "uint16") -> np.ndarray:
    return (np.rint(UNIT * top) + low).astype(dtype)


@pytest.fixture(scope="module")
def eight_bits() -> tuple[int, float]:
    with stream_of(PHOTO, tune="visual") as stream:
        return stream.size, decibels(PHOTO, stream.read())


@pytest.mark.parametrize(
    "pixels",
    [
        scaled(1023),
        scaled(4095),
        scaled(16383),
        scaled(65535),
        scaled(10000),
        scaled(4080),
        scaled(4095, -2048, "float32"),
        (UNIT * 0.37 + 5).astype(np.float32),
    ],
    ids=["10 bits", "12", "14", "16", "0-10000", "12 by shift", "signed", "float"],
)
def test_quality_means_the_same_at_any_depth(pixels: np.ndarray, eight_bits: tuple[int, float]) -> None:
    with stream_of(pixels, tune="visual") as stream:
        decoded = stream.read()
    assert decoded.dtype == pixels.dtype
    assert stream.size == pytest.approx(eight_bits[0], rel=0.03)
    assert decibels(pixels, decoded) == pytest.approx(eight_bits[1], abs=0.3)


@pytest.mark.parametrize("tile", [0, 64])
def test_a_hot_pixel_changes_nothing_else_and_stays(tile: int) -> None:
    pixels = scaled(4095)
    with stream_of(pixels, tile=tile) as plain:
        expected = plain.read()
    pixels[70, 61], pixels[9, 9, 1] = 65535, 60000
    with stream_of(pixels, tile=tile) as stream:
        decoded = stream.read()
        part = stream.read(region=(58, 68, 8, 8))
        enlarged = stream.read(scale=2.0)
    hot = pixels > 4095
    np.testing.assert_array_equal(decoded[hot], pixels[hot])
    np.testing.assert_array_equal(part, decoded[68:76, 58:66])
    assert (enlarged > 4095).sum() == 4 * hot.sum()
    rest = ~hot.any(axis=-1)
    assert decibels(pixels[rest], decoded[rest]) == pytest.approx(decibels(pixels[rest], expected[rest]), abs=0.3)


@pytest.mark.parametrize("tile", [0, 64])
@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float32"])
def test_nodata_of_each_band_is_its_own(dtype: str, tile: int) -> None:
    """No sample that is valid decodes to nodata, at any scale, and none that is nodata to another value."""
    pixels = scaled(255, 1 if dtype != "uint8" else 0, dtype)
    pixels[:60, :50] = 0
    pixels[:60, 50:100, 1] = 0
    pixels[100:110, 100:110] = 1  # next to nodata
    with stream_of(pixels, channels="multi", nodata=0, tile=tile) as stream:
        np.testing.assert_array_equal(stream.read() == 0, pixels == 0)
        half = stream.read(scale=0.5)
        np.testing.assert_array_equal(half == 0, pixels[1::2, 1::2] == 0)
        twice = stream.read(scale=2.0)
        np.testing.assert_array_equal(twice == 0, np.repeat(np.repeat(pixels == 0, 2, axis=0), 2, axis=1))


@pytest.mark.parametrize("tile", [0, 64])
def test_not_a_number_and_infinity_come_back(tile: int) -> None:
    pixels = (UNIT * 40 - 7).astype(np.float32)
    pixels[20:50, 30:90] = np.nan
    pixels[3, 4, 1] = np.nan
    pixels[100, 100] = np.inf
    with stream_of(pixels, tile=tile) as stream:
        decoded = stream.read()
    np.testing.assert_array_equal(np.isnan(decoded), np.isnan(pixels))
    np.testing.assert_array_equal(np.isinf(decoded), np.isinf(pixels))
    sound = np.isfinite(pixels)
    assert np.abs(decoded[sound] - pixels[sound]).mean() < 0.6


@pytest.mark.parametrize(
    ("choice", "expected"),
    [("used", (0.0, 3000.0)), ("type", (0.0, 65535.0)), ("0,4095", (0.0, 4095.0)), (None, (0.0, 3000.0))],
)
def test_the_command_line_chooses_a_range(tmp_path: Path, choice: str | None, expected: tuple[float, float]) -> None:
    picture = Picture(scaled(3000), "rgb", (0.0, 65535.0))
    sgicodec.write(picture, tmp_path / "in.png")
    given = [] if choice is None else ["--range", choice]
    found = done("encode", tmp_path / "in.png", "-e", 1, *given)
    assert sgicodec.open(tmp_path / "in.sgi").header.sample_range == expected
    assert f"dB of the range {expected[0]:g} to {expected[1]:g}" in found.output


def test_bands_of_a_tiff_have_ranges_of_their_own(tmp_path: Path) -> None:
    """Three that are called gray, as GDAL writes them, are no colours. One of a single value comes back exactly."""
    ramp = np.linspace(0, 1, 96 * 64, dtype=np.float32).reshape(64, 96)
    pixels = np.stack([ramp, np.full_like(ramp, 1013.25), 1e4 * ramp[::-1]])
    tifffile.imwrite(tmp_path / "x.tif", pixels, photometric="minisblack", planarconfig="separate")
    decoded = sgicodec.decode(sgicodec.encode(tmp_path / "x.tif", effort=1))
    assert np.abs(decoded[..., 0] - ramp).max() < 0.1
    assert np.ptp(decoded[..., 1]) == 0
