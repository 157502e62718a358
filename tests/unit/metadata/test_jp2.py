"""EXIF, XMP and the place in boxes of JPEG 2000."""

from __future__ import annotations

import struct
import sys
from pathlib import Path

import numpy as np
import pytest
import rasterio
from image_files import save
from rasterio.transform import from_origin
from tags import exif_blob

from sgicodec import open_source, read, write
from sgicodec.metadata.jp2 import find

PIXELS = np.random.default_rng(1).integers(0, 256, (64, 80, 3)).astype(np.uint8)
PLACE = {"crs": "EPSG:32633", "transform": from_origin(5e5, 5e6, 10, 20)}
XMP = bytes.fromhex("be7acfcb97a942e89c71999491e3afac")


def placed(path: Path, **options: str) -> Path:
    form = {"driver": "JP2OpenJPEG", "width": 80, "height": 64, "count": 3, "dtype": "uint8", "QUALITY": "100"}
    with rasterio.open(path, "w", **form, REVERSIBLE="YES", **PLACE, **options) as file:
        file.write(np.moveaxis(PIXELS, -1, 0))
    return path


def boxed(path: Path, *uuids: tuple[bytes, bytes]) -> Path:
    """A picture whose file has these boxes behind those that say what it is."""
    data = save(path, PIXELS).read_bytes()
    assert data[12:20] == b"\0\0\0\x14ftyp"
    boxes = [struct.pack(">I4s", 24 + len(contents), b"uuid") + uuid + contents for uuid, contents in uuids]
    path.write_bytes(b"".join((data[:32], *boxes, data[32:])))
    return path


@pytest.mark.parametrize("options", [{}, {"GMLJP2": "NO"}, {"GeoJP2": "NO"}])
def test_the_place_comes(options: dict[str, str], tmp_path: Path) -> None:
    with open_source(placed(tmp_path / "a.jp2", **options)) as source:
        assert source.notes == ()
        write(source.read(0, 0, 80, 64), tmp_path / "a.tif")
    with rasterio.open(tmp_path / "a.tif") as file:
        assert (file.crs, file.transform) == (rasterio.CRS.from_string(PLACE["crs"]), PLACE["transform"])
        np.testing.assert_array_equal(np.moveaxis(file.read(), 0, -1), PIXELS)


def test_a_place_in_gml_alone_is_said_without_gdal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = placed(tmp_path / "a.jp2", GeoJP2="NO")
    monkeypatch.setitem(sys.modules, "rasterio", None)
    with open_source(path) as source:
        assert source.notes == ("not kept: its place (GML; the extra tiff reads it)",)
        assert source.metadata.geo is None


def test_exif_and_xmp_come_and_the_picture_is_turned(tmp_path: Path) -> None:
    found = read(boxed(tmp_path / "a.jp2", (XMP, b"<x:xmpmeta/>"), (b"JpgTiffExif->JP2", exif_blob()), (XMP, b"2")))
    assert found.metadata.xmp == b"<x:xmpmeta/>"
    assert b"Maker" in found.metadata.exif
    np.testing.assert_array_equal(found.pixels, np.rot90(PIXELS, -1))


@pytest.mark.parametrize("cut", [34, 59, 60, 90])
def test_of_a_file_that_is_cut_off_what_stands_before_is_read(cut: int, tmp_path: Path) -> None:
    whole = boxed(tmp_path / "a.jp2", (XMP, b"<x/>")).read_bytes()
    assert find(whole[:cut]) == (None, b"<x/>" if cut >= 60 else None, None)


def test_damaged_places_are_none(tmp_path: Path) -> None:
    geo = bytes.fromhex("b14bf8bd083d4b43a5ae8cd7d5a6ce03")
    with open_source(boxed(tmp_path / "a.jp2", (geo, b"II*\0\xff\xff\xff\xff"))) as source:
        assert source.metadata.geo is None
