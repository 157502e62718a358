"""AVIF pictures by libavif: samples, alpha, crop, turns and metadata, in files that libaom wrote, most without loss."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from image_files import SRGB, by_pillow
from PIL import Image

from sgicodec import read
from sgicodec.errors import PictureError
from sgicodec.image.reader import is_picture, probe
from sgicodec.metadata import exif
from sgicodec.metadata.orientation import upright

PIXELS = np.random.default_rng(3).integers(0, 256, (48, 64, 3), np.uint8)
SLOPE = (np.mgrid[:48, :64].sum(0)[..., None] + np.array([0, 40, 90])).astype(np.uint8)
XMP = b"<x:xmpmeta xmlns:x='adobe:ns:meta/' tiff:Orientation='6'/>"


def saved(pixels: np.ndarray, **settings: Any) -> bytes:
    """A file by Pillow: 8 bits, at full resolution, one level off where colours turn to luma and back."""
    return by_pillow(pixels, "AVIF", quality=100, speed=10, **{"subsampling": "4:4:4"} | settings)


def exact(pixels: np.ndarray, bits: int) -> bytes:
    """A file without loss, of any depth."""
    imagecodecs = pytest.importorskip("imagecodecs")
    return bytes(imagecodecs.avif_encode(pixels, level=100, bitspersample=bits, speed=10))


@pytest.mark.parametrize("bits", [8, 10, 12])
@pytest.mark.parametrize("layout", ["gray", "gray+alpha", "rgb", "rgba"])
def test_all_depths_and_layouts(bits: int, layout: str) -> None:
    count = {"gray": 1, "gray+alpha": 2, "rgb": 3, "rgba": 4}[layout]
    stored = np.random.default_rng(bits).integers(0, 1 << bits, (48, 64, count)).astype("u1" if bits == 8 else "u2")
    picture = read(exact(stored.squeeze(), bits))
    assert picture.channels == layout
    scale = 255 if bits == 8 else 65535
    np.testing.assert_array_equal(picture.pixels, stored.astype(np.uint32) * scale // ((1 << bits) - 1))


@pytest.mark.parametrize("orientation", range(1, 9))
def test_every_turn_is_applied_once(orientation: int) -> None:
    """The file says how to turn it, which Pillow has put in from the EXIF."""
    tags = Image.Exif()
    tags[274], tags[271] = orientation, "Maker"
    height, width = SLOPE.shape[:2]
    tags.get_ifd(34665).update({40962: width, 40963: height})
    data = saved(SLOPE, exif=tags.tobytes())
    picture = read(data)
    assert np.abs(picture.pixels.astype(int) - upright(SLOPE, orientation)).max() <= 3
    kept = Image.Exif()
    kept.load(picture.metadata.exif)
    assert (kept.get(274, 1), kept[271]) == (1, "Maker")
    inner = kept.get_ifd(34665)
    assert (inner[40962], inner[40963]) == picture.pixels.shape[1::-1]
    assert (probe(data).width, probe(data).height) == picture.pixels.shape[1::-1]


def cropped(data: bytes, window: tuple[int, int, int, int]) -> bytes:
    """The file with its profile of 28 bytes replaced by a crop: both boxes take 40 bytes."""
    at = data.index(b"colrprof") - 4
    assert int.from_bytes(data[at : at + 4], "big") == 40
    x, y, width, height = window
    centre = 2 * x + width - 64, 2 * y + height - 48
    box = struct.pack(">I4sIIIIiIiI", 40, b"clap", width, 1, height, 1, centre[0], 2, centre[1], 2)
    data = data[:at] + box + data[at + 40 :]
    place, index = data.index(b"ipco") + 4, 1
    while place != at:  # which property it is: all readers must know this one
        place, index = place + int.from_bytes(data[place : place + 4], "big"), index + 1
    rows = data.index(b"ipma")
    return data[:rows] + data[rows:].replace(bytes([index]), bytes([0x80 | index]), 1)


@pytest.mark.parametrize("orientation", [1, 6, 7])
def test_the_crop_comes_before_the_turn(orientation: int) -> None:
    tags = Image.Exif()
    tags[274] = orientation
    data = saved(SLOPE, icc_profile=bytes(28), exif=tags.tobytes())
    pixels = read(cropped(data, (10, 4, 33, 21))).pixels
    expected = upright(SLOPE[4:25, 10:43], orientation)
    assert pixels.shape == expected.shape
    assert np.abs(pixels.astype(int) - expected).max() <= 3
    with pytest.raises(PictureError, match="its crop is not one of whole pixels inside the picture"):
        read(cropped(data, (40, 4, 33, 21)))


def test_metadata_are_kept() -> None:
    tags = Image.Exif()
    tags[271] = "Maker"
    metadata = read(saved(SLOPE, exif=tags.tobytes(), xmp=XMP, icc_profile=SRGB)).metadata
    assert metadata.xmp == XMP.replace(b"'6'", b"'1'")
    assert metadata.icc == SRGB
    assert metadata.exif == exif.upright(tags.tobytes())


@pytest.mark.parametrize("share", [0.01, 0.03, 0.3, 0.9])
def test_what_is_cut_off_is_refused(share: float, tmp_path: Path) -> None:
    data = saved(PIXELS)
    (tmp_path / "a.avif").write_bytes(data[: int(share * len(data))])
    with pytest.raises(PictureError, match=r"a\.avif: the file is damaged or cut off: "):
        read(tmp_path / "a.avif")
    assert is_picture(tmp_path / "a.avif")
