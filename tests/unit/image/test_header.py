from __future__ import annotations

import io
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
import tifffile

from sgicodec.errors import PictureError
from sgicodec.image import open_source, read
from sgicodec.metadata import ifd, tiff

Save = Callable[..., Path]


@pytest.mark.parametrize("open_it", [read, open_source])
def test_doubles_in_tiles_are_refused(tmp_path: Path, save: Save, open_it: Callable[[Path], object]) -> None:
    path = save(tmp_path / "x.tif", np.ones((20, 20, 1)), tile=(16, 16))
    with pytest.raises(PictureError, match="64-bit floats are in tiles"):
        open_it(path)


def _white_is_zero(path: Path) -> Path:
    """Change the photometric interpretation of a file that OpenImageIO wrote."""
    tiff.insert(path, None, None, None)
    data = path.read_bytes()
    (row,) = (
        row for row in ifd.rows(data, int.from_bytes(data[4:8], "little"), ifd.Layout("<", False)) if row.tag == 262
    )
    path.write_bytes(data[: row.at] + b"\0\0" + data[row.at + 2 :])
    return path


def test_white_is_zero(tmp_path: Path, save: Save) -> None:
    ramp = np.arange(0, 200, 2, dtype=np.uint8).reshape(10, 10, 1)
    np.testing.assert_array_equal(read(_white_is_zero(save(tmp_path / "x.tif", ramp))).pixels, 255 - ramp)
    deep = ramp.astype(np.uint16) * 300
    np.testing.assert_array_equal(read(_white_is_zero(save(tmp_path / "y.tif", deep))).pixels, 65535 - deep)


@pytest.mark.parametrize("dtype", ["int8", "int16", "int32", "uint32", "float16", "float32", "float64"])
def test_white_is_zero_in_other_types(tmp_path: Path, dtype: str) -> None:
    tifffile.imwrite(tmp_path / "x.tif", np.ones((4, 4), dtype), photometric="miniswhite")
    with pytest.raises(PictureError, match=r"x\.tif: 0 is white in its \w+ samples, .* invert it first"):
        read(tmp_path / "x.tif")


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
@pytest.mark.parametrize("layout", [{}, {"planarconfig": "separate"}, {"tile": (16, 16)}])
@pytest.mark.parametrize("extra", ["unassalpha", "assocalpha", "unspecified"])
def test_where_white_is_zero_other_samples_stay(
    tmp_path: Path, dtype: str, layout: dict[str, object], extra: str
) -> None:
    most = np.iinfo(dtype).max
    ink, other = np.full((16, 32), most // 16, dtype), np.full((16, 32), most // 2, dtype)
    samples = np.stack([ink, other], axis=0 if "planarconfig" in layout else -1)
    options: dict[str, object] = {"planarconfig": "contig", "extrasamples": [extra], **layout}
    tifffile.imwrite(tmp_path / "x.tif", samples, photometric="miniswhite", **options)
    picture = read(tmp_path / "x.tif")
    ink_alone = most // 16 * most / (most // 2) if extra == "assocalpha" else most // 16
    assert picture.channels == ("multi" if extra == "unspecified" else "gray+alpha")
    np.testing.assert_allclose(picture.pixels[..., 0], most - ink_alone, atol=1)
    np.testing.assert_array_equal(picture.pixels[..., 1], other)
    with open_source(tmp_path / "x.tif") as source:
        np.testing.assert_array_equal(source.read(3, 4, 20, 9).pixels, picture.pixels[4:13, 3:23])


@pytest.mark.parametrize("name", ["int16", "int8", "double", "half"])
def test_other_sample_types_become_float(tmp_path: Path, name: str) -> None:
    stored = np.array([[-3, 0], [5, 100]], {"double": "f8", "half": "f2"}.get(name, name))[..., None]
    spec = oiio.ImageSpec(2, 2, 1, name)
    spec.attribute("tiff:half", 1)
    image = oiio.ImageOutput.create("x.tif")
    assert image.open(str(tmp_path / "x.tif"), spec)
    assert image.write_image(stored)
    image.close()
    picture = read(tmp_path / "x.tif")
    assert picture.pixels.dtype == np.float32
    assert picture.pixels.ravel().tolist() == [-3.0, 0.0, 5.0, 100.0]
    assert picture.sample_range == (-3.0, 100.0)


def test_one_row_of_doubles_is_refused(tmp_path: Path) -> None:
    image = oiio.ImageOutput.create("x.tif")
    assert image.open(str(tmp_path / "x.tif"), oiio.ImageSpec(2, 1, 1, "double"))
    assert image.write_image(np.ones((1, 2, 1)))
    image.close()
    with pytest.raises(PictureError, match="64-bit"):
        read(tmp_path / "x.tif")


def test_cielab_is_refused() -> None:
    image = pytest.importorskip("PIL.Image")
    file = io.BytesIO()
    image.new("LAB", (4, 4)).save(file, "TIFF")
    with pytest.raises(PictureError, match="CIELAB"):
        read(file.getvalue())


def test_few_bits_fill_the_type() -> None:
    ten_bits = b"P5 3 1 1023\n" + struct.pack(">HHH", 0, 512, 1023)
    assert read(ten_bits).pixels.ravel().tolist() == pytest.approx([0, 512 / 1023 * 65535, 65535], abs=40)
    one_bit = b"P4 8 1\n" + bytes([0b10100000])
    assert read(one_bit).pixels.ravel().tolist() == [0, 255, 0, 255, 255, 255, 255, 255]
