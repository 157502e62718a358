"""HEIF pictures by libheif: samples, turns, alpha and metadata, in files that libheif wrote without loss."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pillow_heif
import pytest
from image_files import SRGB
from PIL import Image

from sgicodec import open_source, read
from sgicodec.errors import PictureError
from sgicodec.metadata import exif

PIXELS = np.random.default_rng(3).integers(0, 256, (48, 64, 3), np.uint8)
XMP = b"<x:xmpmeta xmlns:x='adobe:ns:meta/' tiff:Orientation='6'/>"


def saved(image: Image.Image | pillow_heif.HeifFile, **settings: Any) -> bytes:
    """A file without loss: RGB as it is, at full resolution."""
    if isinstance(image, Image.Image):
        image = pillow_heif.from_pillow(image)
    file = io.BytesIO()
    image.save(file, quality=-1, chroma=444, matrix_coefficients=0, **settings)
    return file.getvalue()


@pytest.mark.parametrize("alpha", ["auto", "band", "none"])
def test_colours_and_alpha(alpha: Any) -> None:
    pixels = np.dstack([PIXELS, np.where(PIXELS[..., 0] > 99, 255, 77).astype(np.uint8)])
    picture = read(saved(Image.fromarray(pixels)), alpha=alpha)
    assert picture.channels == {"auto": "rgba", "band": "multi", "none": "rgb"}[alpha]
    np.testing.assert_array_equal(picture.pixels, pixels[..., : 3 if alpha == "none" else 4])


def test_colours_that_are_multiplied_by_alpha() -> None:
    alpha = np.where(PIXELS[..., :1] > 99, 255, 128).astype(np.uint8)
    pixels = np.dstack([np.minimum(PIXELS, alpha), alpha])
    picture = read(saved(pillow_heif.from_bytes(mode="RGBa", size=(64, 48), data=pixels.tobytes())))
    assert picture.channels == "rgba"
    expected = np.rint(pixels[..., :3] * (255.0 / alpha))
    np.testing.assert_allclose(picture.pixels, np.dstack([expected, alpha]), rtol=0, atol=1)


def test_ten_bits_become_sixteen() -> None:
    deep = np.arange(48 * 64 * 3).reshape(48, 64, 3) % 1024
    stored = pillow_heif.from_bytes(mode="RGB;10", size=(64, 48), data=deep.astype(np.uint16).tobytes())
    picture = read(saved(stored))
    assert picture.pixels.dtype == np.uint16
    np.testing.assert_array_equal(picture.pixels, deep * 65535 // 1023)


@pytest.mark.parametrize(
    ("numbers", "info", "notes"),
    [
        ((1, 13), {}, ()),
        ((9, 16), {}, ("not kept: colour space (nclx)",)),
        ((9, 16), {"icc_profile": b"x"}, ()),
        (
            (1, 13),
            {"aux": {"urn:com:apple:photo:2020:aux:hdrgainmap": [2]}},
            ("not kept: further pictures (a gain map, depth)",),
        ),
    ],
)
def test_what_is_not_kept_is_said(
    numbers: tuple[int, int], info: dict[str, Any], notes: tuple[str, ...], tmp_path: Path
) -> None:
    path = tmp_path / "a.heic"
    own = {"color_primaries": numbers[0], "transfer_characteristics": numbers[1], "full_range_flag": 1}
    path.write_bytes(saved(Image.fromarray(PIXELS), save_nclx_profile=True, **own))
    with open_source(path) as source:
        source._opened.image._image.info.update(info)
        assert source.notes == notes


def test_turns_and_metadata() -> None:
    """The file says how to turn it, and so does its EXIF: it is turned once."""
    tags = Image.Exif()
    tags[274], tags[271] = 6, "Maker"
    data = saved(Image.fromarray(PIXELS), exif=tags.tobytes(), xmp=XMP, icc_profile=SRGB)
    picture = read(data)
    np.testing.assert_array_equal(picture.pixels, np.rot90(PIXELS, -1))
    assert picture.metadata.xmp == XMP.replace(b"'6'", b"'1'")
    assert picture.metadata.icc == SRGB
    assert picture.metadata.exif == exif.upright(tags.tobytes())
    kept = Image.Exif()
    kept.load(picture.metadata.exif)
    assert (kept[274], kept[271]) == (1, "Maker")


@pytest.mark.parametrize("share", [0.3, 0.9])
def test_what_is_cut_off_is_refused(share: float, tmp_path: Path) -> None:
    data = saved(Image.fromarray(PIXELS))
    (tmp_path / "a.heic").write_bytes(data[: int(share * len(data))])
    with pytest.raises(PictureError, match=r"a\.heic: the file is damaged or cut off: "):
        read(tmp_path / "a.heic")


def test_damage_that_libheif_does_not_find() -> None:
    """A size that its pixels do not have, and a primary picture that is none."""
    whole = saved(Image.fromarray(PIXELS))
    size = whole.index(b"ispe") + 8
    for at, change in ((size, b"\0\0\x30\x40"), (whole.index(b"infe") + 12, b"\0\0\0\0")):
        with pytest.raises(PictureError, match="damaged"):
            read(whole[:at] + change + whole[at + 4 :])
