from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from image_files import notes_of, packed, save
from tags import TIED, doubles, geo_keys, rational, shorts, text

from sgicodec import open_source, read
from sgicodec.metadata import geo, ifd, placement, tiff
from sgicodec.picture import Metadata, Picture, full_range

ALL: dict[int, ifd.Entry] = {
    282: rational(20000),
    283: rational(10000),
    296: shorts(3),
    **TIED,
    34735: geo_keys((1024, 0, 1, 1), (1025, 0, 1, 1)),
    34736: doubles(6378137.0, 298.25),
    34737: text("WGS 84|"),
    42112: text("<GDALMetadata/>"),
    42113: text("7"),
    50844: doubles(*range(92)),
}


def _tagged(path: Path, tags: dict[int, ifd.Entry]) -> Path:
    """Give a file that OpenImageIO wrote these tags."""
    tiff.insert(path, None, None, None)
    data = path.read_bytes()
    at = len(data)
    path.write_bytes(data[:4] + struct.pack("<I", at) + data[8:] + ifd.dump({**ifd.load(data), **tags}, at))
    return path


def _picture(blob: bytes | None, pixels: np.ndarray | None = None) -> Picture:
    pixels = np.zeros((4, 6, 3), np.uint8) if pixels is None else pixels
    return Picture(pixels, {1: "gray", 3: "rgb"}[pixels.shape[2]], full_range(pixels.dtype), Metadata(geo=blob))


def test_the_blob_of_the_documentation() -> None:
    blob = geo.pack({42113: text("-9999"), 33550: doubles(10.0, 10.0, 0.0), 271: text("x")})
    rows = "0E 83 0C 00 03 00 00 00 26 00 00 00  81 A4 02 00 06 00 00 00 3E 00 00 00"
    values = "0000000000002440 0000000000002440 0000000000000000  2D 39 39 39 39 00"
    assert blob == bytes.fromhex(f"49 49 2A 00 08 00 00 00  02 00  {rows}  00 00 00 00  {values}")


def test_tags_survive_a_tiff(tmp_path: Path) -> None:
    path = _tagged(save(tmp_path / "x.tif", np.zeros((4, 6, 3), np.uint8)), ALL)
    with open_source(path) as source:
        blob = source.metadata.geo
    assert geo.load(blob) == ALL
    data = packed(_picture(blob), "tiff")
    directory = ifd.load(data)
    assert {tag: directory[tag] for tag in ALL} == ALL
    assert read(data).metadata == Metadata(geo=blob)


@pytest.mark.parametrize(
    ("stated", "dtype", "expected"),
    [
        (b"0\0", "uint8", 0.0),
        (b"255", "uint8", 255.0),
        (b"256\0", "uint8", None),
        (b"-9999\0", "float32", -9999.0),
        (b"0.5\0", "uint8", None),
        (b" 1e3 \0", "uint16", 1000.0),
        (b"-3.4028234663852886e+38\0", "float32", float(np.finfo(np.float32).min)),
        (b"0.1\0", "float32", float(np.float32(0.1))),
        (b"1.7976931348623157e+308\0", "float32", np.inf),
        (b"nan\0", "uint8", None),
        (b"nan\0", "float32", np.nan),
        (b"no number\0", "uint8", None),
        (b"\xff\0", "uint8", None),
        (b"7\0junk", "uint8", 7.0),
    ],
)
def test_nodata(stated: bytes, dtype: str, expected: float | None) -> None:
    np.testing.assert_equal(geo.nodata(geo.pack({42113: ifd.Entry(2, stated)}), np.dtype(dtype)), expected)
    assert geo.nodata(None, np.dtype(dtype)) is None


@pytest.mark.parametrize(
    ("bits", "dtype", "nodata"), [(4, "uint8", 9), (1, "uint8", 1), (10, "uint16", 511), (12, "uint16", 4000)]
)
def test_nodata_is_stretched_like_its_samples(tmp_path: Path, bits: int, dtype: str, nodata: int) -> None:
    most, largest = (1 << bits) - 1, int(np.iinfo(dtype).max)
    pixels = np.full((8, 8, 1), (nodata * largest + most - 1) // most, dtype)
    pixels[0] = 0
    path = save(tmp_path / "x.tif", pixels, oiio__BitsPerSample=bits)
    stated, name = "<GDALMetadata>{}{}</GDALMetadata>", '<Item name="DESCRIPTION" role="description">B4</Item>'
    scale = '<Item name="SCALE" sample="0" role="scale">0.1</Item>'
    _tagged(path, {42113: text(f"{nodata}"), 33550: ALL[33550], 42112: text(stated.format(scale, name))})
    picture = read(path)
    assert picture.nodata == picture.pixels[5, 5, 0]
    assert picture.nodata is not None
    assert picture.nodata == pytest.approx(nodata / most * largest, abs=1)
    assert geo.load(picture.metadata.geo).keys() == {33550, 42112, 42113}
    assert geo.load(picture.metadata.geo)[42112] == text(stated.format("", name))
    assert notes_of(path)[1:] == ("not kept: scale",)


def test_nodata_that_its_samples_cannot_have_is_said(tmp_path: Path) -> None:
    path = _tagged(save(tmp_path / "x.tif", np.zeros((8, 8, 1), np.uint8), oiio__BitsPerSample=4), {42113: text("99")})
    assert notes_of(path) == ("samples v of its 4 bits become 8 bits, v · 17", "not kept: nodata value")


ANY_ENTRY = st.builds(ifd.Entry, st.sampled_from([1, 2, 3, 4, 5, 12]), st.binary(min_size=8, max_size=768))


@given(st.dictionaries(st.sampled_from(sorted(geo.TAGS)), ANY_ENTRY), st.integers(1, 8))
def test_tags_of_odd_types_and_sizes_do_no_harm(tags: dict[int, ifd.Entry], orientation: int) -> None:
    whole = {tag: ifd.Entry(kind, data[: len(data) // 8 * 8]) for tag, (kind, data) in tags.items()}
    with np.errstate(all="ignore"):
        placement.oriented(geo.pack(dict(whole)), orientation, 5, 7)
        placement.view(geo.pack(dict(whole)), 1, 2, 0.5, 3)
