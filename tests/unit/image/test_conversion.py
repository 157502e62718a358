"""What a caller has at hand as a Picture."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from image_files import SRGB, by_pillow
from PIL import Image

from sgicodec.errors import UsageError
from sgicodec.image.conversion import as_picture
from sgicodec.metadata import density, ifd

RGB = np.random.default_rng(0).integers(0, 256, (5, 7, 3), np.uint8)


@pytest.mark.parametrize(
    ("array", "channels", "sample_range"),
    [
        (RGB[..., 0], "gray", (0.0, 255.0)),
        (RGB[..., :1], "gray", (0.0, 255.0)),
        (RGB[..., :2], "gray+alpha", (0.0, 255.0)),
        (RGB, "rgb", (0.0, 255.0)),
        (np.dstack([RGB, RGB[..., 0]]), "rgba", (0.0, 255.0)),
        (np.dstack([RGB, RGB]), "multi", (0.0, 255.0)),
        (RGB.astype(np.uint16) * 257, "rgb", (0.0, 65535.0)),
        (RGB.astype(">u2"), "rgb", (0.0, 255.0)),
        (RGB.astype(np.float64) - 3, "rgb", (float(RGB.min()) - 3, float(RGB.max()) - 3)),
        (RGB[::2, ::-1], "rgb", (0.0, 255.0)),
    ],
)
def test_arrays(array: Any, channels: str, sample_range: tuple[float, float]) -> None:
    picture = as_picture(array)
    assert (picture.channels, picture.sample_range) == (channels, sample_range)
    np.testing.assert_array_equal(picture.pixels, array.reshape(*array.shape[:2], -1))
    assert picture.pixels.dtype.isnative


@pytest.mark.parametrize(
    ("mode", "channels"),
    [("L", "gray"), ("LA", "gray+alpha"), ("RGB", "rgb"), ("RGBA", "rgba"), ("F", "gray"), ("I;16", "gray")],
)
def test_images_of_pillow_keep_their_samples(mode: str, channels: str) -> None:
    shape = {"gray": (5, 7), "gray+alpha": (5, 7, 2), "rgb": (5, 7, 3), "rgba": (5, 7, 4)}[channels]
    dtype = {"F": np.float32, "I;16": np.uint16}.get(mode, np.uint8)
    samples = np.random.default_rng(1).integers(0, 256, shape).astype(dtype)
    picture = as_picture(Image.fromarray(samples))
    assert picture.channels == channels
    np.testing.assert_array_equal(picture.pixels.squeeze(), samples)


@pytest.mark.parametrize(
    ("mode", "channels"), [("1", "gray"), ("P", "rgb"), ("CMYK", "rgb"), ("YCbCr", "rgb"), ("I", "gray")]
)
def test_other_modes_of_pillow_are_converted(mode: str, channels: str) -> None:
    image = Image.fromarray(RGB[..., 0]).convert(mode) if mode in ("1", "I") else Image.fromarray(RGB).convert(mode)
    picture = as_picture(image)
    assert picture.channels == channels
    shown = np.asarray(image.convert("L" if mode == "1" else "RGB" if channels == "rgb" else mode))
    np.testing.assert_array_equal(picture.pixels.squeeze(), shown)


def test_images_of_pillow_are_what_their_files_are() -> None:
    """Turned upright, with profile and EXIF."""
    exif = Image.Exif()
    exif[0x0112], exif[0x010E] = 6, "a day out"
    exif.get_ifd(0x8769).update({40962: 7, 40963: 5})
    data = by_pillow(RGB, "png", exif=exif, dpi=(254, 508), icc_profile=SRGB)
    picture, expected = as_picture(Image.open(io.BytesIO(data))), as_picture(data)
    np.testing.assert_array_equal(picture.pixels, expected.pixels)
    assert picture.pixels.shape == (7, 5, 3)
    assert picture.metadata.icc == expected.metadata.icc is not None
    assert b"a day out" in picture.metadata.exif
    inner = ifd.load(picture.metadata.exif)[ifd.EXIF_IFD]
    assert inner == {40962: ifd.Entry(3, b"\5\0"), 40963: ifd.Entry(3, b"\7\0")}
    stated = [density.density(each.metadata.geo, None) for each in (picture, expected)]
    assert [each and each.dpi for each in stated] == [pytest.approx((508, 254))] * 2


@pytest.mark.parametrize(
    ("image", "options", "complaint"),
    [
        (RGB.astype(np.int64), {}, "array of int64"),
        (np.ma.masked_less(RGB.astype(np.int64), 3), {}, "array of int64"),
        (RGB[0, 0], {}, r"\[H, W\]"),
        (np.zeros((0, 4), np.uint8), {}, "not empty"),
        (np.full((2, 2), 1e300), {}, "beyond float32"),
        (RGB, {"channels": "bgr"}, "there are gray"),
        (RGB, {"channels": ["red", "green", "blue"]}, "there are gray"),
        (RGB, {"channels": "gray"}, "3 channels cannot be"),
        (RGB.astype(np.float32), {"sample_range": 3}, "two numbers"),
        (RGB, {"nodata": "3"}, "it must be a number"),
        (RGB.astype(np.float32), {"nodata": 1e300}, "no sample of float32"),
        (Image.fromarray(RGB), {"channels": "rgb"}, "has a mode"),
        ("a.png", {"channels": "rgb"}, "has its own"),
        (None, {}, "NoneType is no picture"),
        ([[1, 2], [3, 4]], {}, "list is no picture"),
    ],
)
def test_bad_arguments(image: object, options: dict[str, Any], complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint):
        as_picture(image, **options)
