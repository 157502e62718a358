"""Streams in Pillow, beside the pictures of Silicon Graphics."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from data_files import GOLDEN, PICTURES
from image_files import SRGB
from PIL import Image

import sgicodec
from sgicodec.errors import UsageError
from sgicodec.metadata.orientation import upright
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
    image = Image.fromarray(np.random.default_rng(2).integers(0, 256, (24, 32, 3), np.uint8))
    exif = Image.Exif()
    exif[271] = "Maker"
    image.info |= {
        "dpi": (300, 150),
        "icc_profile": SRGB,
        "exif": exif.tobytes(),
        "xmp": b"<x:xmpmeta xmlns:x='adobe:ns:meta/'/>",
    }
    buffer = io.BytesIO()
    image.save(buffer, format=FORMAT, quality=70, steps=4)
    again = Image.open(buffer)
    assert (again.info["icc_profile"], again.info["xmp"]) == (SRGB, image.info["xmp"])
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


@pytest.mark.parametrize("own", [None, 3, 6])
@pytest.mark.parametrize("stated", [None, 1, 6])
def test_a_given_exif_turns_the_image(own: int | None, stated: int | None) -> None:
    """As a JPEG saved with it would be shown; one that says nothing leaves the word to the image's own."""
    pixels = np.random.default_rng(3).integers(0, 256, (24, 32, 3), np.uint8)
    image, other = Image.fromarray(pixels), Image.Exif()
    if own is not None:
        image.getexif()[274] = own
        image.info["exif"] = image.getexif().tobytes()
    other[271] = "Other"
    if stated is not None:
        other[274] = stated
    for given in (other, other.tobytes()):
        image.save(buffer := io.BytesIO(), FORMAT, max_error=0, effort=1, exif=given, dpi=(300, 150))
        again = Image.open(buffer)
        np.testing.assert_array_equal(np.asarray(again), upright(pixels, stated or own or 1))
        assert again.getexif().get(274, 1) == 1
        assert again.getexif()[271] == "Other"
        assert again.info["dpi"] == ((150, 300) if (stated or own) == 6 else (300, 150))


def test_what_is_not_kept_is_said() -> None:
    image = Image.fromarray(np.zeros((24, 32, 4), np.uint8), "CMYK")
    with pytest.warns(UserWarning, match=r"not kept: inks \(RGB instead\)"):
        image.save(io.BytesIO(), FORMAT, steps=4)
    frames = [Image.new("L", (32, 24), shade) for shade in (9, 90)]
    frames[0].save(buffer := io.BytesIO(), "GIF", save_all=True, append_images=frames[1:])
    with pytest.warns(UserWarning, match="not kept: another frame"):
        Image.open(buffer).save(io.BytesIO(), FORMAT, steps=4)
    with pytest.raises(UsageError, match="one picture"):
        frames[0].save(io.BytesIO(), FORMAT, save_all=True)


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
