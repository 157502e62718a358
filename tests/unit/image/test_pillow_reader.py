"""Pictures that Pillow reads where OpenImageIO does not."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from image_files import by_pillow
from PIL import Image

from sgicodec import read
from sgicodec.errors import PictureError

PIXELS = np.random.default_rng(3).integers(0, 256, (33, 20, 3), np.uint8)


def rle8() -> bytes:
    """A BMP of 4 × 2 pixels in RLE8: a run of four, then two runs of two, from the bottom up."""
    palette = bytes([0, 0, 0, 0, 30, 20, 10, 0, 60, 50, 40, 0])
    data = bytes([4, 1, 0, 0, 2, 2, 2, 0, 0, 0, 0, 1])
    start = 54 + len(palette)
    header = struct.pack("<IiiHHIIiiII", 40, 4, 2, 1, 8, 1, len(data), 0, 0, 3, 3)
    return struct.pack("<2sIHHI", b"BM", start + len(data), 0, 0, start) + header + palette + data


@pytest.mark.parametrize("name", ["QOI", "PCX"])
def test_colours(name: str) -> None:
    picture = read(by_pillow(PIXELS, name))
    assert picture.channels == "rgb"
    np.testing.assert_array_equal(picture.pixels, PIXELS)


def test_run_lengths_of_bmp() -> None:
    rows = [[[40, 50, 60]] * 2 + [[0, 0, 0]] * 2, [[10, 20, 30]] * 4]
    np.testing.assert_array_equal(read(rle8()).pixels, rows)


def test_of_icons_the_largest_is_read() -> None:
    data = by_pillow(PIXELS[:32, :20], "ICO", sizes=[(8, 8), (16, 16), (20, 32)], bitmap_format="bmp")
    np.testing.assert_array_equal(read(data).pixels[..., :3], PIXELS[:32, :20])


def test_inks_of_jpeg_2000() -> None:
    inks = np.dstack([PIXELS, PIXELS[..., 0] // 2]).repeat(2, axis=1)
    picture = read(by_pillow(Image.fromarray(inks, "CMYK"), "JPEG2000"))
    left = 1 - inks / 255
    assert picture.channels == "rgb"
    np.testing.assert_allclose(picture.pixels, 255 * left[..., :3] * left[..., 3:], atol=1.01)


def test_gray_and_alpha_of_jpeg_2000() -> None:
    pixels = PIXELS[..., :2].repeat(2, axis=1)
    picture = read(by_pillow(pixels, "JPEG2000"))
    assert picture.channels == "gray+alpha"
    np.testing.assert_array_equal(picture.pixels, pixels)


@pytest.mark.parametrize("name", ["QOI", "PCX"])
def test_cut_files_are_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / f"x.{name}"
    path.write_bytes(by_pillow(PIXELS, name)[:400])
    with pytest.raises(PictureError, match=r"x\.\w+: the file is damaged or cut off"):
        read(path)
