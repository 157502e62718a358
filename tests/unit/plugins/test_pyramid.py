"""Pyramids in TIFF, as tifffile and GDAL read them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tifffile
from command import done, refused, sgi, told
from data_files import GOLDEN
from image_files import SRGB

import sgicodec
from sgicodec.decoder import bands
from sgicodec.metadata import geo, ifd
from sgicodec.metadata.gdal_items import band_facts, named_bands
from sgicodec.picture import Metadata, Picture
from sgicodec.plugins.ome_name import is_ome_name
from sgicodec.plugins.pyramid import write_pyramid

WIDTH, HEIGHT = 520, 300


@pytest.fixture(scope="module")
def stream() -> sgicodec.Stream:
    """A ramp in six tiles, with a profile, a resolution and EXIF."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    pixels = np.stack([x % 256, y % 256, (x + y) // 5], axis=2).astype(np.uint8)
    exif = b"II*\0\x08\0\0\0" + bytes.fromhex("0100 0f01 0200 0600 0000 1a00 0000 0000 0000") + b"Maker\0"
    resolution = bytes.fromhex("0300 1a01 0500 0100 0000 3200 0000 1b01 0500 0100 0000 3a00 0000 2801 0300 0100 0000")
    geo = b"II*\0\x08\0\0\0" + resolution + bytes.fromhex("0300 0000 0000 0000 409c 0000 0100 0000 204e 0000 0100 0000")
    metadata = Metadata(icc=SRGB, exif=exif, xmp=b"<x:xmpmeta xmlns:x='adobe:ns:meta/'/>", geo=geo)
    picture = Picture(pixels, "rgb", (0, 255), metadata)
    return sgicodec.open(sgicodec.encode(picture, steps=2, tile=256, rdoq=False, overview=False))


@pytest.mark.parametrize("name", ["a.ome.tif", "a.OME.TIFF", "a.tif"])
def test_levels_are_those_of_the_stream(
    name: str, stream: sgicodec.Stream, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In bands that do not end with rows of tiles."""
    monkeypatch.setattr(bands, "BAND_SAMPLES", 70 * WIDTH * 3)
    rows: list[int] = []
    write_pyramid(stream, tmp_path / name, done=rows.append)
    assert rows == [70, 140, 210, 280, 300]
    with tifffile.TiffFile(tmp_path / name) as file:
        assert file.is_ome == is_ome_name(name)
        assert len(file.pages) == (1 if file.is_ome else 3)
        levels = file.series[0].levels
        assert [level.shape for level in levels] == [(300, 520, 3), (150, 260, 3), (75, 130, 3)]
        for found, level in zip(levels, stream.levels, strict=True):
            np.testing.assert_array_equal(found.asarray(), stream.read(size=level[:2]))
            assert found.keyframe.tile == (256, 256)
            assert found.keyframe.compression == tifffile.COMPRESSION.ADOBE_DEFLATE
    assert sorted(path.name for path in tmp_path.iterdir()) == [name]


def test_metadata_of_ome(stream: sgicodec.Stream, tmp_path: Path) -> None:
    """A pixel is a quarter of a micrometre wide and half of one high."""
    write_pyramid(stream, tmp_path / "a.ome.tif", region=(100, 30, 300, 260), scale=0.5)
    with tifffile.TiffFile(tmp_path / "a.ome.tif") as file:
        pixels = tifffile.xml2dict(file.ome_metadata)["OME"]["Image"]["Pixels"]
        assert (pixels["SizeX"], pixels["SizeY"], pixels["SizeC"]) == (150, 130, 3)
        assert (pixels["PhysicalSizeX"], pixels["PhysicalSizeY"]) == (0.5, 1.0)
        assert pixels["PhysicalSizeXUnit"] == "µm"
        tags = file.pages[0].tags
        assert tags[34675].value == stream.metadata.icc
        assert tags[271].value == "Maker"
        assert tags[700].value == stream.metadata.xmp
        assert [above / below for above, below in (tags[282].value, tags[283].value)] == [20000, 10000]
        expected = stream.read(region=(100, 30, 300, 260), scale=0.5)
        np.testing.assert_array_equal(file.asarray(), expected)


def test_the_command(stream: sgicodec.Stream, tmp_path: Path) -> None:
    path = GOLDEN / "rgb8-tiles.sgi"
    for arguments in ((tmp_path / "a.ome.tiff",), (tmp_path / "b.tif", "--pyramid", "--scale", 4, "--depth", 16)):
        done("decode", path, *arguments, "--quiet")
    with tifffile.TiffFile(tmp_path / "a.ome.tiff") as one, tifffile.TiffFile(tmp_path / "b.tif") as two:
        assert (one.is_ome, two.is_ome) == (True, False)
        assert two.pages[0].dtype == np.uint16
        assert [level.shape[1] for level in two.series[0].levels] == [768, 384, 192]
    out = sgi("decode", path, "-", "--pyramid")
    (tmp_path / "c.tif").write_bytes(out.stdout_bytes)
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "c.tif"), sgicodec.imread(path))
    for wrong in (("a.png", "--pyramid"), ("a.tif", "--pyramid", "--cog")):
        refused(2, "decode", path, *wrong)


def test_a_slide_keeps_its_objective_and_the_size_of_its_pixels(tmp_path: Path) -> None:
    description = b"Aperio Image Library v1\r\n48x32 JPEG/RGB Q=30|AppMag = 40|MPP = 0.2500|Left = 25.69\0"
    exif = b"II*\0\x08\0\0\0" + ifd.dump({270: ifd.Entry(2, description)}, 8)
    picture = Picture(np.zeros((32, 48, 3), np.uint8), "rgb", (0, 255), Metadata(exif=exif))
    source = tmp_path / "a.sgi"
    sgicodec.imwrite(source, picture, steps=1, rdoq=False)
    assert "0.25 µm per pixel (Aperio MPP)\n  objective   40×" in sgi("info", source).output
    for out, options in (("a.ome.tif", ()), ("b.ome.tif", ()), ("a.tif", ("--pyramid", "--scale", "1/4"))):
        done("decode", source, tmp_path / out, *options, "--quiet")
    assert (tmp_path / "a.ome.tif").read_bytes() == (tmp_path / "b.ome.tif").read_bytes()
    with tifffile.TiffFile(tmp_path / "a.ome.tif") as file:
        found = tifffile.xml2dict(file.ome_metadata)["OME"]
        assert found["Instrument"]["Objective"]["NominalMagnification"] == 40
        assert found["Image"]["ObjectiveSettings"]["ID"] == found["Instrument"]["Objective"]["ID"]
        assert found["Image"]["Pixels"]["PhysicalSizeY"] == 0.25
    done("encode", tmp_path / "a.ome.tif", tmp_path / "again.sgi", "-e", 1, "--quiet")
    facts = told("info", tmp_path / "again.sgi")
    assert (facts["magnification"], facts["resolution"]["microns_per_pixel"]) == ("40", [0.25, 0.25])
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        assert file.pages[0].description.endswith("|AppMag = 40|MPP = 1|Left = 25.69")


@pytest.mark.parametrize("compression", ["deflate", "jpeg:95"])
def test_bands_without_a_meaning_are_planes_with_names(compression: str, tmp_path: Path) -> None:
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    pixels = np.stack([x % 256, y % 256, (x + y) // 5, (x - y) % 256], axis=2).astype(np.uint8)
    tags = geo.pack(named_bands(["DAPI", "", "Cy5 <far>", "Cy7"]))
    picture, source = Picture(pixels, "multi", (0, 255), Metadata(geo=tags)), tmp_path / "a.sgi"
    sgicodec.imwrite(source, picture, steps=2, tile=256, rdoq=False, overview=False)
    done("decode", source, tmp_path / "a.ome.tif", "--compress", compression, "--quiet")
    most = 0 if compression == "deflate" else 40
    with tifffile.TiffFile(tmp_path / "a.ome.tif") as file, sgicodec.open(source) as stream:
        assert file.series[0].axes == "CYX"
        names = [
            channel.get("Name") for channel in tifffile.xml2dict(file.ome_metadata)["OME"]["Image"]["Pixels"]["Channel"]
        ]
        assert names == ["DAPI", "", "Cy5 <far>", "Cy7"]
        assert len(file.series[0].levels) == len(stream.levels)
        for level, size in zip(file.series[0].levels, stream.levels, strict=True):
            expected = np.moveaxis(stream.read(size=size[:2]), -1, 0).astype(int)
            assert np.abs(level.asarray() - expected).max() <= most
    again = sgicodec.read(tmp_path / "a.ome.tif")
    assert [facts.description for facts in band_facts(again.metadata.geo, 4)] == ["DAPI", None, "Cy5 <far>", "Cy7"]


def test_progress_counts_the_rows_of_all_planes(tmp_path: Path) -> None:
    rows: list[int] = []
    with sgicodec.open(GOLDEN / "multi8.sgi") as stream:
        write_pyramid(stream, tmp_path / "a.ome.tif", done=rows.append)
        assert rows == sorted(rows)
        assert len(rows) == stream.header.spec.channels
        assert rows[-1] == stream.height
