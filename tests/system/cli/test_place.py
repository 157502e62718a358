"""What `sgi` says and keeps of a picture's place on the map."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from command import done, sgi, told
from data_files import PICTURES
from PIL import Image
from tags import TIED, geo_keys, geo_of, rational, shorts, text

import sgicodec
from sgicodec import read, write
from sgicodec.metadata import geo, ifd
from sgicodec.picture import Metadata, Picture


@pytest.fixture(scope="module")
def placed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The stream of a GeoTIFF with a nodata value and a resolution."""
    folder = tmp_path_factory.mktemp("placed")
    rows = [(1024, 0, 1, 1), (1025, 0, 1, 1), (1026, 34737, 22, 0), (3072, 0, 1, 32633), (3076, 0, 1, 9001)]
    scale = {282: rational(10000), 283: rational(10000), 296: shorts(3)}
    system = {34735: geo_keys(*rows), 34737: text("WGS 84 / UTM zone 33N|"), 42113: text("0")}
    blob = geo_of({**scale, **TIED, **system})
    pixels = np.full((24, 40, 3), 90, np.uint8)
    pixels[:4] = 0
    write(Picture(pixels, "rgb", (0.0, 255.0), Metadata(geo=blob)), folder / "x.tif")
    done("encode", folder / "x.tif", "--steps", 5)
    return folder / "x.sgi"


def test_a_stream_with_a_place_becomes_a_tiff(placed: Path) -> None:
    before = read(placed.with_suffix(".tif")).metadata.geo
    placed.with_suffix(".tif").unlink()
    assert done("decode", placed).stderr == ""
    assert not placed.with_suffix(".png").exists()
    assert read(placed.with_suffix(".tif")).metadata.geo == before
    assert geo.load(before).keys() == {282, 283, 296, 33550, 33922, 34735, 34737, 42113}
    assert sgi("decode", placed, "-").stdout_bytes[:4] == b"II*\0"


def test_info_shows_the_place(placed: Path) -> None:
    lines = [line.split(maxsplit=1) for line in sgi("info", placed).stdout.splitlines() if line.strip()]
    shown = {line[0]: line[1] for line in lines if len(line) == 2}
    assert shown["projection"] == "EPSG:32633, WGS 84 / UTM zone 33N"
    assert shown["bounds"] == "500000 to 500400, 5999760 to 6000000 m"
    assert shown["pixel"] == "10 × 10 m"
    assert shown["nodata"] == "0"
    assert shown["resolution"] == "1 µm per pixel (10000 pixels per cm)"
    facts = told("info", placed)
    assert facts["place"] == {
        "epsg": 32633,
        "name": "WGS 84 / UTM zone 33N",
        "bounds": [500000, 5999760, 500400, 6000000],
        "pixel_size": [10, 10],
        "unit": "m",
        "rotated": False,
    }
    assert facts["nodata"] == 0
    assert facts["resolution"] == {"microns_per_pixel": [1, 1], "stated": "10000 pixels per cm"}


@pytest.mark.parametrize(
    ("view", "size", "area", "dpi"),
    [
        ([], (48, 64), [27, 10, 6, 8], (150, 300)),
        (["--scale", 2], (96, 128), [55, 21, 12, 16], (300, 600)),
        (["--size", "24x32!"], (24, 32), [13, 5, 3, 4], (75, 150)),
        (["--region", "20,8,10,12"], (10, 12), [7, 2, 6, 8], (150, 300)),
        (["--region", "0,0,10,12", "--scale", 0.5], (5, 6), None, (75, 150)),
    ],
)
def test_exif_and_xmp_say_what_a_view_shows(
    turned: Path, tmp_path: Path, view: list[object], size: tuple[int, int], area: list[int] | None, dpi: object
) -> None:
    for name in ("a.jpg", "a.png", "a.tif"):
        done("decode", turned, tmp_path / name, *view)
        with Image.open(tmp_path / name) as found:
            tags = found.getexif()
            packet = found.tag_v2[700] if name == "a.tif" else found.info["xmp"]
            assert found.size == size
            inner = tags.get_ifd(ifd.EXIF_IFD)
        assert (inner[40962], inner[40963]) == size
        assert inner.get(37396) == (area and tuple(area))
        assert (tags[282], tags[283], tags.get(274, 1)) == (*dpi, 1)
        assert b'tiff:ImageWidth="%d" tiff:ImageLength="%d"' % size in packet


@pytest.fixture(scope="module")
def turned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The stream of a photograph of 64×48 stored pixels, to be turned by a quarter."""
    folder = tmp_path_factory.mktemp("turned")
    tags = Image.Exif()
    tags.update({274: 6, 282: 300, 283: 150, 296: 2})
    tags.get_ifd(ifd.EXIF_IFD).update({40962: 64, 40963: 48, 37396: (10, 20, 8, 6)})
    xmp = b'<a tiff:ImageWidth="64" tiff:ImageLength="48"/>'
    pixels = np.tile(np.arange(64, dtype=np.uint8), (48, 1))
    Image.fromarray(pixels).save(folder / "a.jpg", exif=tags.tobytes(), xmp=xmp)
    done("encode", folder / "a.jpg", "--steps", 5)
    return folder / "a.sgi"


def test_statistics_are_not_those_of_new_pixels(tmp_path: Path) -> None:
    """And a nodata value is found however it is written."""
    items = '<Item name="NOTE">kept</Item><Item name="STATISTICS_MAXIMUM" sample="0">143.25</Item>'
    texts = {42112: f"<GDALMetadata>{items}</GDALMetadata>", 42113: "-1.#QNAN"}
    pixels = np.tile(np.linspace(1, 9, 40, dtype=np.float32), (24, 1))
    pixels[:4, :4] = np.nan
    tags = [(tag, 2, len(text) + 1, text, True) for tag, text in texts.items()]
    tifffile.imwrite(tmp_path / "x.tif", pixels, metadata=None, extratags=tags)
    done("encode", tmp_path / "x.tif", "--steps", 5)
    done("decode", tmp_path / "x.sgi", tmp_path / "y.tif")
    with tifffile.TiffFile(tmp_path / "y.tif") as file:
        assert file.pages.first.tags[42112].value == '<GDALMetadata><Item name="NOTE">kept</Item></GDALMetadata>'
        assert np.array_equal(np.isnan(file.asarray()), np.isnan(pixels))


@pytest.mark.parametrize(
    ("name", "extension", "lost"),
    [
        ("exif_gps.jpg", "bmp", "EXIF"),
        ("exif_gps.jpg", "jxl", "EXIF"),
        ("exif_gps.jpg", "jpeg", None),
        ("icc_profile.png", "ppm", "ICC profile"),
        ("icc_profile.png", "jxl", None),
    ],
)
def test_metadata_that_a_format_does_not_hold_is_named(
    tmp_path: Path, name: str, extension: str, lost: str | None
) -> None:
    done("encode", PICTURES / name, tmp_path / "x.sgi", "--steps", 2)
    found = done("decode", tmp_path / "x.sgi", tmp_path / f"x.{extension}")
    named = f"sgi: {tmp_path / 'x'}.{extension}: .{extension} does not hold its {lost}; .tif does\n"
    assert found.stderr == ("" if lost is None else named)


@pytest.mark.parametrize(("option", "kind"), [("--pyramid", "pyramid"), ("--cog", "COG"), (None, "pyramid")])
def test_exif_that_pyramids_do_not_hold_is_said(tmp_path: Path, option: str | None, kind: str) -> None:
    done("encode", PICTURES / "exif_gps.jpg", tmp_path / "x.sgi", "--steps", 2)
    out = tmp_path / ("x.tif" if option else "x.ome.tif")
    found = done("decode", tmp_path / "x.sgi", out, *[option] * bool(option))
    assert found.stderr == f"sgi: {out}: a {kind} does not hold all of its EXIF; a plain .tif does\n"
    with Image.open(out) as image:
        assert not image.getexif().get_ifd(ifd.GPS_IFD)


@pytest.mark.parametrize(("nodata", "is_lost"), [(7.0, True), (float("nan"), False)])
def test_a_nodata_value_without_a_place(nodata: float, is_lost: bool, tmp_path: Path) -> None:
    """Of an array. Not-a-number says itself what it is."""
    pixels = np.full((24, 40), 90, np.float32)
    pixels[:4] = nodata
    sgicodec.imwrite(tmp_path / "x.sgi", pixels, nodata=nodata, steps=2)
    assert f"nodata      {nodata:g}\n" in sgi("info", tmp_path / "x.sgi").stdout
    found = sgi("decode", tmp_path / "x.sgi", tmp_path / "x.exr")
    assert ("does not hold its nodata value" in found.stderr) == is_lost
    done("decode", tmp_path / "x.sgi")
    with tifffile.TiffFile(tmp_path / "x.tif") as file:
        assert float(file.pages.first.tags[42113].value) == pytest.approx(nodata, nan_ok=True)


@pytest.mark.parametrize(("depth", "is_lost"), [(8, True), (16, True), (32, False)])
def test_not_a_number_is_lost_among_integers(depth: int, is_lost: bool, tmp_path: Path) -> None:
    pixels = np.full((24, 40), 90, np.float32)
    pixels[:4] = np.nan
    sgicodec.imwrite(tmp_path / "x.sgi", pixels, nodata=float("nan"), steps=2)
    out = tmp_path / ("x.pfm" if depth == 32 else "x.png")
    lines = done("decode", tmp_path / "x.sgi", out, "--depth", depth).stderr
    assert (f"sgi: {out}: .png does not hold its nodata value; .tif does\n" in lines) == is_lost
    assert ("samples are rescaled" in lines) == is_lost
    done("decode", tmp_path / "x.sgi", "--depth", depth)
    assert (tmp_path / "x.tif").exists()  # which holds it


@pytest.mark.parametrize("extension", ["jpg", "png"])
def test_a_resolution_that_is_not_held_is_said(extension: str, tmp_path: Path) -> None:
    stated: dict[str, Any] = {"resolution": (2.5e-4, 2.5e-4), "resolutionunit": 3, "metadata": None, "software": False}
    tifffile.imwrite(tmp_path / "x.tif", np.zeros((24, 40), np.uint8), **stated)
    done("encode", tmp_path / "x.tif", "--steps", 2)
    out = tmp_path / f"x.{extension}"
    assert f".{extension} does not hold its resolution; .tif does" in done("decode", tmp_path / "x.sgi", out).stderr


_ITEM = '<Item name="{}" sample="0" role="{}">{}</Item>'


@pytest.fixture(scope="module")
def scaled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The stream of samples that stand for others."""
    folder = tmp_path_factory.mktemp("scaled")
    items = (
        _ITEM.format("SCALE", "scale", 0.1),
        _ITEM.format("OFFSET", "offset", 3),
        _ITEM.format("A", "description", "a"),
    )
    blob = geo_of({42112: text(f"<GDALMetadata>{''.join(items)}</GDALMetadata>")})
    pixels = np.tile(np.arange(40, dtype=np.uint16) * 100, (24, 1))[..., None]
    write(Picture(pixels, "gray", (0.0, 65535.0), Metadata(geo=blob)), folder / "x.tif")
    done("encode", folder / "x.tif", "--steps", 2)
    return folder / "x.sgi"


@pytest.mark.parametrize(
    ("name", "depth", "lines"),
    [
        ("a.png", 16, [".png does not hold its scale, offset and names of bands; .tif does"]),
        ("a.tif", 16, []),
        ("a.tif", 8, ["samples are rescaled to 0 to 255; scale and offset are not kept"]),
        ("a.tif", 32, ["samples are rescaled to 0 to 1; scale and offset are not kept"]),
        (
            "a.png",
            8,
            [
                "samples are rescaled to 0 to 255; scale and offset are not kept",
                ".png does not hold its names of bands; .tif does",
            ],
        ),
    ],
)
def test_numbers_that_a_decode_loses_are_named(
    scaled: Path, name: str, depth: int, lines: list[str], tmp_path: Path
) -> None:
    found = sgi("decode", scaled, tmp_path / name, "--depth", depth)
    assert found.stderr == "".join(f"sgi: {tmp_path / name}: {line}\n" for line in lines)
    if name == "a.tif":
        stated = geo.load(read(tmp_path / name).metadata.geo)[42112].data
        assert (b">a</Item>" in stated, b'role="scale"' in stated) == (True, depth == 16)
