"""TIFF files that GDAL reads where OpenImageIO does not: sparse ones, and other compressions."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
import tifffile
from image_files import notes_of
from rasterio.windows import Window

from sgicodec import open_source, read
from sgicodec.errors import PictureError

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")

WIDTH, HEIGHT = 70, 50
WINDOWS = [(0, 0, WIDTH, HEIGHT), (3, 40, 33, 10), (60, 5, 10, 20), (0, 0, 1, 1)]


def samples(bands: int, dtype: str, most: int = 200) -> np.ndarray:
    random = np.random.default_rng(bands)
    low = -most if np.dtype(dtype).kind in "if" else 0
    return random.integers(low, most, (bands, HEIGHT, WIDTH), endpoint=True).astype(dtype)


def save(path: Path, pixels: np.ndarray, rows: int = HEIGHT, **options: Any) -> Path:
    """Writes the first rows of pixels [bands, h, w] by GDAL; the others are sparse."""
    shape: dict[str, Any] = {"count": len(pixels), "height": HEIGHT, "width": WIDTH, "dtype": pixels.dtype.name}
    with rasterio.open(path, "w", driver="GTiff", SPARSE_OK="TRUE", **shape, **options) as file:
        file.write(pixels[:, :rows], window=Window(0, 0, WIDTH, rows))
        if options.get("photometric") == "PALETTE":
            file.write_colormap(1, {index: (index, 255 - index, 7, 255) for index in range(256)})
    return path


def check(path: Path, expected: np.ndarray) -> None:
    """The whole and windows of it are the samples [h, w, bands]."""
    picture = read(path)
    np.testing.assert_array_equal(picture.pixels, expected)
    with open_source(path) as source:
        assert source.channels == picture.channels
        for x, y, width, height in WINDOWS:
            part = source.read(x, y, width, height).pixels
            np.testing.assert_array_equal(part, expected[y : y + height, x : x + width])


TILES = {"tiled": True, "blockxsize": 32, "blockysize": 16}
LAYOUTS: list[dict[str, Any]] = [TILES, TILES | {"BIGTIFF": "YES"}, {"blockysize": 16}, TILES | {"interleave": "band"}]


@pytest.mark.parametrize("layout", LAYOUTS, ids=["tiles", "big", "strips", "planes"])
@pytest.mark.parametrize(("dtype", "bands", "nodata"), [("uint8", 1, None), ("uint8", 3, 255), ("float32", 2, -9999)])
def test_what_a_sparse_file_lacks_is_nodata_or_0(
    tmp_path: Path, layout: dict[str, Any], dtype: str, bands: int, nodata: float | None
) -> None:
    pixels = samples(bands, dtype)
    path = save(tmp_path / "x.tif", pixels, 32, nodata=nodata, compress="DEFLATE", **layout)
    pixels[:, 32:] = nodata or 0
    check(path, np.moveaxis(pixels, 0, -1))


@pytest.mark.parametrize("options", [{}, TILES, {"compress": "ZSTD"}], ids=["strips", "tiles", "by GDAL"])
def test_integers_of_24_bits(tmp_path: Path, options: dict[str, Any]) -> None:
    """OpenImageIO shifts them to 32."""
    pixels = samples(1, "uint32", 1 << 24)
    path = save(tmp_path / "x.tif", pixels, NBITS=24, nodata=77, **options)
    check(path, np.moveaxis(pixels, 0, -1))
    assert read(path).nodata == 77


@pytest.mark.parametrize("compression", ["ZSTD", "LERC", "LERC_DEFLATE", "LERC_ZSTD", "LZMA"])
@pytest.mark.parametrize("layout", [TILES, {"blockysize": 16}], ids=["tiles", "strips"])
@pytest.mark.parametrize("dtype", ["uint8", "int16", "uint16", "float32", "float64"])
def test_compressions(tmp_path: Path, compression: str, layout: dict[str, Any], dtype: str) -> None:
    pixels = samples(1, dtype)
    path = save(tmp_path / "x.tif", pixels, compress=compression, **layout)
    check(path, np.moveaxis(pixels, 0, -1))


BANDS = [*(("MINISBLACK", bands) for bands in range(1, 5)), ("RGB", 3), ("RGB", 4)]


@pytest.mark.parametrize(
    ("photometric", "bands", "interleave"),
    [*((*bands, "pixel") for bands in BANDS), *((*bands, "band") for bands in (*BANDS, ("RGB", 5)))],
)
@pytest.mark.parametrize("alpha", [{}, {"alpha": "YES"}])
def test_bands_in_jpeg_are_those_that_gdal_reads(
    tmp_path: Path, photometric: str, bands: int, interleave: str, alpha: dict[str, str]
) -> None:
    """Where they are neither gray nor RGB, OpenImageIO gives the first three times and an alpha of 255."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    pixels = np.stack([(x * (band + 1) + 40 * band + y) % 256 // 2 for band in range(bands)]).astype(np.uint8)
    options = {"compress": "JPEG", "photometric": photometric, "interleave": interleave, **alpha}
    path = save(tmp_path / "x.tif", pixels, **options)
    with rasterio.open(path) as file:
        expected = np.moveaxis(file.read(), 0, -1).astype(int)
    found = read(path, alpha="band").pixels.astype(int)
    np.testing.assert_allclose(found, expected, rtol=0, atol=3)


def test_samples_are_what_openimageio_makes_of_them(tmp_path: Path) -> None:
    """DEFLATE is read by OpenImageIO, ZSTD by GDAL."""
    kinds: dict[str, tuple[np.ndarray, dict[str, Any]]] = {
        "palette": (samples(1, "uint8"), {"photometric": "PALETTE"}),
        "4 bits": (samples(1, "uint8", 15), {"nbits": 4}),
        "12 bits": (samples(1, "uint16", 4095), {"nbits": 12}),
        "half": (samples(1, "float32"), {"nbits": 16}),
        "white is 0": (samples(1, "uint8"), {"photometric": "MINISWHITE"}),
        "deep white is 0": (samples(1, "uint16"), {"photometric": "MINISWHITE"}),
        "inks": (samples(4, "uint8", 255), {"photometric": "CMYK"}),
        "inks in planes": (samples(4, "uint8", 255), {"photometric": "CMYK", "interleave": "band"} | TILES),
        "deep inks": (samples(4, "uint16", 65535), {"photometric": "CMYK"}),
        "alpha": (samples(4, "uint8"), {"photometric": "RGB", "alpha": "YES"}),
        "associated": (np.sort(samples(4, "uint8"), axis=0), {"photometric": "RGB", "alpha": "PREMULTIPLIED"}),
        "bands": (samples(6, "int16"), {}),
    }
    for name, (pixels, options) in kinds.items():
        by_openimageio = read(save(tmp_path / f"{name} a.tif", pixels, compress="DEFLATE", **options))
        picture = read(save(tmp_path / f"{name} b.tif", pixels, compress="ZSTD", **options))
        assert picture.channels == by_openimageio.channels, name
        np.testing.assert_allclose(picture.pixels, by_openimageio.pixels, atol=int("inks" in name), err_msg=name)


@pytest.mark.parametrize("compression", ["DEFLATE", "ZSTD"])
def test_that_12_bits_are_stretched_is_said(tmp_path: Path, compression: str) -> None:
    pixels = samples(1, "uint16", 4095)
    path = save(tmp_path / "x.tif", pixels, nbits=12, compress=compression)
    assert notes_of(path) == ("samples v of its 12 bits become 16 bits, v · 65535 / 4095 rounded down",)
    check(path, pixels[0, ..., None].astype(int) * 65535 // 4095)


def test_inks_that_gdal_has_mixed_are_refused(tmp_path: Path) -> None:
    path = save(tmp_path / "x.tif", samples(5, "uint8", 255), compress="ZSTD", photometric="CMYK")
    with pytest.raises(PictureError, match="GDAL finds 4 of its 5 channels; convert it first"):
        read(path)


def test_without_rasterio(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sparse = save(tmp_path / "a.tif", samples(1, "uint8"), 32, **TILES)
    packed = save(tmp_path / "b.tif", samples(1, "uint8"), compress="ZSTD")
    monkeypatch.setitem(sys.modules, "rasterio", None)
    remedy = r"reading it needs rasterio: pip install 'sgicodec\[tiff\]', or convert it first, as with gdal_translate"
    with pytest.raises(PictureError, match=rf"a\.tif: it is sparse, .*; {remedy}"):
        read(sparse)
    with pytest.raises(PictureError, match=rf"b\.tif: it is compressed by ZSTD; {remedy}"):
        read(packed)


def test_damage_is_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = save(tmp_path / "x.tif", samples(1, "uint8"), compress="ZSTD")
    with tifffile.TiffFile(path) as file:
        place = file.pages.first.dataoffsets[0]
    data = bytearray(path.read_bytes())
    data[place : place + 40] = bytes(40)
    path.write_bytes(data)
    with pytest.raises(PictureError, match=r"x\.tif: the file is damaged or cut off: .*"):
        read(path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("bands", [1, 3])
def test_wide_floats_in_tiles(bands: int, tmp_path: Path) -> None:
    pixels = samples(bands, "float64")
    check(save(tmp_path / "a.tif", pixels, **TILES), np.moveaxis(pixels, 0, -1).astype(np.float32))


@pytest.mark.parametrize(("shape", "what"), [((16, 16), "in tiles"), ((1, 16), "a single row")])
def test_wide_floats_need_gdal(
    shape: tuple[int, int], what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tifffile.imwrite(tmp_path / "a.tif", np.ones(shape), tile=(16, 16) if shape[0] > 1 else None)
    assert read(tmp_path / "a.tif").pixels.shape == (*shape, 1)
    monkeypatch.setitem(sys.modules, "rasterio", None)
    with pytest.raises(PictureError, match=f"its 64-bit floats are {what}; reading it needs rasterio"):
        read(tmp_path / "a.tif")


def test_a_palette_of_8_bits(tmp_path: Path) -> None:
    """OpenImageIO takes the upper half of 16 bits, and all is black."""
    colours = np.arange(256, dtype=np.uint16)[None] // [[1], [2], [3]]
    options = {"photometric": "palette", "colormap": colours.astype(np.uint16), "metadata": None}
    tifffile.imwrite(tmp_path / "x.tif", np.arange(256, dtype=np.uint8).reshape(16, 16), **options)
    np.testing.assert_array_equal(read(tmp_path / "x.tif").pixels.reshape(-1, 3), colours.T)
