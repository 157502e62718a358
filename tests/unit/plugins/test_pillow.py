"""Streams in Pillow, beside the pictures of Silicon Graphics."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from data_files import GOLDEN, PICTURES
from PIL import Image, ImageCms

import sgicodec
from sgicodec.picture import Metadata
from sgicodec.plugins.pillow import FORMAT, register


@pytest.fixture(autouse=True)
def _extensions() -> Iterator[None]:
    """What extensions mean is as it was."""
    Image.init()
    before = dict(Image.EXTENSION)
    yield
    Image.EXTENSION.clear()
    Image.EXTENSION.update(before)


@pytest.mark.parametrize(
    ("name", "mode", "dtype"),
    [
        ("rgb8", "RGB", "uint8"),
        ("rgba8", "RGBA", "uint8"),
        ("gray8-alpha", "LA", "uint8"),
        ("gray16", "I;16", "uint16"),
        ("float", "F", "float32"),
        ("rgb8-tiles", "RGB", "uint8"),
    ],
)
def test_modes_and_samples(name: str, mode: str, dtype: str) -> None:
    with Image.open(GOLDEN / f"{name}.sgi") as image, sgicodec.open(GOLDEN / f"{name}.sgi") as stream:
        assert (image.format, image.mode, image.size) == (FORMAT, mode, (stream.width, stream.height))
        np.testing.assert_array_equal(np.asarray(image), stream.read(dtype=dtype))
        assert image.get_format_mimetype() == "image/x-sgicodec"


@pytest.mark.parametrize("size", [(20, 20), (7, 40), (500, 10)])
def test_thumbnails_come_from_the_decoder(size: tuple[int, int]) -> None:
    path = GOLDEN / "rgb8-tiles.sgi"
    image, whole = Image.open(path), Image.open(path)
    whole.load()
    image.thumbnail(size)
    whole.thumbnail(size)
    assert image.size == whole.size
    assert np.abs(np.asarray(image, float) - np.asarray(whole)).mean() < 3


def test_saving_and_opening_keeps_metadata() -> None:
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    image = Image.fromarray(np.random.default_rng(2).integers(0, 256, (24, 32, 3), np.uint8))
    exif = Image.Exif()
    exif[271] = "Maker"
    image.info |= {
        "dpi": (300, 150),
        "icc_profile": profile,
        "exif": exif.tobytes(),
        "xmp": b"<x:xmpmeta xmlns:x='adobe:ns:meta/'/>",
    }
    buffer = io.BytesIO()
    image.save(buffer, format=FORMAT, quality=70, steps=4)
    again = Image.open(buffer)
    assert (again.info["icc_profile"], again.info["xmp"]) == (profile, image.info["xmp"])
    assert again.getexif()[271] == "Maker"
    assert again.info["dpi"] == (300, 150)
    bare = io.BytesIO()
    again.save(bare, format=FORMAT, steps=4, exif=b"", icc_profile=None, xmp=b"")
    with sgicodec.open(bare.getvalue()) as stream:
        assert stream.metadata == Metadata(geo=stream.metadata.geo)
    other = Image.Exif()
    other[271] = "Other"
    image.save(bare := io.BytesIO(), format=FORMAT, steps=4, exif=other)
    assert Image.open(bare).getexif()[271] == "Other"


def test_silicon_graphics_goes_on(tmp_path: Path) -> None:
    """By content on opening, by default on saving."""
    image = Image.open(PICTURES / "hopper.sgi")
    assert image.format == "SGI"
    image.save(tmp_path / "old.sgi")
    assert Image.open(tmp_path / "old.sgi").format == "SGI"
    small = image.crop((0, 0, 24, 24))
    register(extension=True)
    small.save(tmp_path / "new.sgi", steps=4)
    assert Image.open(tmp_path / "new.sgi").format == FORMAT
    assert Image.open(tmp_path / "old.sgi").format == "SGI"
    small.save(tmp_path / "old.rgb")
    assert Image.open(tmp_path / "old.rgb").format == "SGI"
