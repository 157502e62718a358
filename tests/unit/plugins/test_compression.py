"""Compressed pyramids in TIFF, as GDAL, OpenSlide and tifffile read them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import openslide
import pytest
import rasterio
import tifffile
from command import done, refused
from data_files import GOLDEN

import sgicodec
from sgicodec.errors import MissingExtraError, PictureError, UsageError
from sgicodec.metadata import geo, ifd
from sgicodec.picture import Metadata, Picture
from sgicodec.plugins.cog import write_cog
from sgicodec.plugins.compression import METHODS, Compression
from sgicodec.plugins.pyramid import write_pyramid

PHOTO = GOLDEN / "rgb8-tiles-texture.sgi"


def written(tmp_path: Path, compression: str, *arguments: object, source: Path = PHOTO) -> Path:
    out = tmp_path / f"{compression.replace(':', '-')}{'.tif' if arguments else '.ome.tif'}"
    done("decode", source, out, "--compress", compression, "--scale", 4, "--quiet", *arguments)
    return out


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    return sgicodec.imread(PHOTO, scale=4).astype(int)


TAGS = {
    "deflate": "DEFLATE",
    "zstd": "ZSTD",
    "jpeg": "YCbCr JPEG",
    "webp": "WEBP",
    "lerc": "LERC",
}


@pytest.mark.parametrize("kind", [(), ("--pyramid",), ("--cog",)])
@pytest.mark.parametrize("name", METHODS)
def test_gdal_reads_every_method_near_the_samples(
    name: str, kind: tuple[str, ...], exact: np.ndarray, tmp_path: Path
) -> None:
    path = written(tmp_path, name, *kind)
    with rasterio.open(path) as file:
        assert file.tags(ns="IMAGE_STRUCTURE")["COMPRESSION"] == TAGS[name]
        found = np.moveaxis(file.read(), 0, -1)
    error = np.abs(found - exact)
    if METHODS[name].layouts is None:
        assert error.max() == 0
    else:
        assert 0 < error.mean() < 2
    again = tifffile.imread(path, level=0).astype(int)  # by other builds of the same libraries
    assert np.abs(again - found).mean() < 0.2


@pytest.mark.parametrize("kind", [(), ("--pyramid",), ("--cog",)])
@pytest.mark.parametrize("name", ["jpeg", "webp"])
def test_quality_orders_sizes(name: str, kind: tuple[str, ...], tmp_path: Path) -> None:
    without = written(tmp_path, "deflate", *kind).stat().st_size
    sizes = [written(tmp_path, f"{name}:{quality}", *kind).stat().st_size for quality in (30, 60, 95)]
    assert sizes == sorted(sizes)
    assert sizes[0] < 0.8 * sizes[1]
    assert sizes[2] < without


@pytest.mark.parametrize("kind", [(), ("--cog",)])
def test_lerc_keeps_its_largest_error(kind: tuple[str, ...], exact: np.ndarray, tmp_path: Path) -> None:
    path = written(tmp_path, "lerc:3", *kind)
    with rasterio.open(path) as file:
        error = np.abs(np.moveaxis(file.read(), 0, -1) - exact)
    assert 0 < error.max() <= 3
    assert path.stat().st_size < written(tmp_path, "lerc", *kind).stat().st_size


def test_openslide_reads_jpeg_at_each_level(tmp_path: Path) -> None:
    with openslide.OpenSlide(written(tmp_path, "jpeg:95", "--pyramid")) as slide, sgicodec.open(PHOTO) as stream:
        for level, (width, height) in enumerate(slide.level_dimensions):
            region = np.asarray(slide.read_region((0, 0), level, (width, height)))[..., :3].astype(int)
            assert np.abs(region - stream.read(size=(width, height))).mean() < 2


def test_alpha_in_webp(tmp_path: Path) -> None:
    source = GOLDEN / "rgba8.sgi"
    path = written(tmp_path, "webp:90", "--cog", source=source)
    with rasterio.open(path) as file, sgicodec.open(source) as stream:
        expected = stream.read(scale=4)
        np.testing.assert_array_equal(file.read(4), expected[..., 3])  # libwebp keeps alpha without loss
        seen = expected[..., 3] > 100
        assert np.abs(np.moveaxis(file.read(), 0, -1).astype(int) - expected)[seen].mean() < 3


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("gzip", "compression 'gzip'; it is one of deflate, zstd, jpeg, webp, lerc, as in jpeg:85"),
        ("zstd:3", "zstd is without loss and takes no number"),
        ("jpeg:0", "the quality of jpeg is a number from 1 to 100"),
        ("jpeg:", "the quality of jpeg is a number from 1 to 100"),
        ("webp:nan", "the quality of webp is a number from 1 to 100"),
        ("lerc:-1", "the largest error of lerc is a number from 0 on"),
        ("lerc:inf", "the largest error of lerc is a number from 0 on"),
    ],
)
def test_what_is_no_compression(text: str, says: str) -> None:
    with pytest.raises(UsageError, match=r"^compression ") as error:
        Compression.parse(text)
    assert says in str(error.value)


def test_what_a_method_does_not_hold(on_map: Path, tmp_path: Path) -> None:
    for source, out, options, says in (
        (PHOTO, "a.tif", ("jpeg", "--cog", "--depth", 16), "jpeg in TIFF holds 8 bits per sample, not 16 bits"),
        (on_map, "a.tif", ("webp", "--cog"), "not floats"),
        (GOLDEN / "rgba8.sgi", "a.tif", ("jpeg", "--cog"), "holds gray and rgb, not rgba"),
        (GOLDEN / "multi8.sgi", "a.tif", ("webp", "--cog"), "not bands without a meaning"),
        (on_map, "a.ome.tif", ("lerc:0.5", "--depth", 32), "changes which samples are nodata (-9999)"),
        (on_map, "a.ome.tif", ("jpeg", "--depth", 8), "changes which samples are nodata (-9999)"),
    ):
        assert says in refused(3, "decode", source, tmp_path / out, "--quiet", "--compress", *options)
        assert not list(tmp_path.iterdir())
    done("decode", on_map, tmp_path / "a.tif", "--cog", "--compress", "lerc", "--quiet")
    with rasterio.open(tmp_path / "a.tif") as file, sgicodec.open(on_map) as stream:
        np.testing.assert_array_equal(file.read(1), stream.read())


def test_compress_is_of_tiff(tmp_path: Path) -> None:
    for out in ("a.tif", "a.png", "a.ome.zarr"):
        assert "--compress is of TIFF" in refused(2, "decode", PHOTO, tmp_path / out, "--compress", "jpeg")


def test_what_compresses_is_missing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(__import__("sys").modules, "imagecodecs", None)
    with sgicodec.open(PHOTO) as stream:
        with pytest.raises(MissingExtraError, match=r"compressing TIFF by jpeg needs imagecodecs"):
            write_pyramid(stream, tmp_path / "a.ome.tif", compression=Compression("jpeg", 80))
        with pytest.raises(PictureError, match="holds gray and rgb"):
            Compression("jpeg", 80).check("multi", np.dtype(np.uint8), None)
    assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def with_nodata() -> sgicodec.Stream:
    """RGB whose corner has the nodata value 7; some channels of other pixels have it, too."""
    y, x = np.mgrid[:300, :520]
    pixels = np.stack([x % 256, y % 256, (x + y) // 5], axis=2).astype(np.uint8)
    pixels[x + y < 200] = 7
    pixels[200:220, :, 0] = 7
    metadata = Metadata(geo=geo.pack({geo.GDAL_NODATA: ifd.Entry(2, b"7\0")}))
    picture = Picture(pixels, "rgb", (0, 255), metadata)
    return sgicodec.open(sgicodec.encode(picture, steps=2, tile=256, rdoq=False, overview=False))


@pytest.mark.parametrize("compression", [Compression("jpeg", 80), Compression("webp", 80), Compression("lerc", 4)])
@pytest.mark.parametrize("write", [write_pyramid, write_cog])
def test_where_samples_are_lossy_a_mask_stands_for_nodata(
    write: Callable[..., None], compression: Compression, with_nodata: sgicodec.Stream, tmp_path: Path
) -> None:
    write(with_nodata, tmp_path / "a.tif", compression=compression)
    for number, (width, height, _) in enumerate(with_nodata.levels):
        level = {} if number == 0 else {"overview_level": number - 1}
        with rasterio.open(tmp_path / "a.tif", **level) as file:
            content = (with_nodata.read(size=(width, height)) != 7).any(axis=2)
            assert 0 < content.mean() < 1
            np.testing.assert_array_equal(file.dataset_mask() > 0, content)
            assert file.nodata is None
    write(with_nodata, tmp_path / "b.tif", compression=Compression("zstd"))
    with rasterio.open(tmp_path / "b.tif") as file:
        assert file.nodata == 7


def test_a_mask_of_heights(on_map: Path, tmp_path: Path) -> None:
    done("decode", on_map, tmp_path / "a.tif", "--cog", "--compress", "lerc:0.5", "--quiet")
    with rasterio.open(tmp_path / "a.tif") as file, sgicodec.open(on_map) as stream:
        expected = stream.read()
        np.testing.assert_array_equal(file.dataset_mask() > 0, expected != -9999)
        error = np.abs(file.read(1) - expected)[expected != -9999]
    assert 0 < error.max() <= 0.5 + 1e-3


def test_bands_without_a_meaning_have_no_common_mask() -> None:
    with pytest.raises(PictureError, match=r"changes which samples are nodata \(0\)"):
        Compression("lerc", 2).check("multi", np.dtype(np.uint8), 0)
    assert not Compression("lerc", 2).needs_mask("multi", 0)
    assert not Compression("lerc", 0).needs_mask("gray", 0)
