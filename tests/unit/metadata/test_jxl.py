"""EXIF and XMP in boxes of JPEG XL."""

from __future__ import annotations

import struct
import sys
from pathlib import Path

import imagecodecs
import numpy as np
import pytest
from image_files import save
from tags import exif_blob

from sgicodec import open_source, read
from sgicodec.errors import PictureError, UsageError
from sgicodec.metadata import exif
from sgicodec.metadata.jxl import find

NOT_READ = "not kept: EXIF or XMP that Brotli compressed (the extra avif reads it)"
PIXELS = np.random.default_rng(1).integers(0, 256, (30, 40, 3)).astype(np.uint8)
SIGNATURE = b"JXL \r\n\x87\n"


def box(kind: bytes, contents: bytes) -> bytes:
    return struct.pack(">I4s", 8 + len(contents), kind) + contents


def brotli(kind: bytes, contents: bytes) -> bytes:
    return box(b"brob", kind + imagecodecs.brotli_encode(contents))


def boxed(path: Path, *more: bytes) -> Path:
    """A picture of 40×30 pixels whose file has these boxes behind those that say what it is."""
    data = save(path, PIXELS, compression="jpegxl:100").read_bytes()
    assert data[4:12] == SIGNATURE
    path.write_bytes(b"".join((data[:32], *more, data[32:])))
    return path


@pytest.mark.parametrize(("sample", "bits"), [("uint8", 8), ("uint16", 10), ("uint16", 16), ("float32", None)])
@pytest.mark.parametrize("boxed", [True, None])
def test_the_first_frame_of_an_animation(sample: str, bits: int | None, boxed: bool | None) -> None:
    frames = np.random.default_rng(4).integers(0, 255, (3, 30, 40, 3)).astype(sample)
    data = imagecodecs.jpegxl_encode(frames, lossless=True, bitspersample=bits, usecontainer=boxed, photometric="rgb")
    with open_source(data) as source:
        expected = frames[0].astype(np.uint32) * 65535 // ((1 << bits) - 1) if bits == 10 else frames[0]
        np.testing.assert_array_equal(source.read(0, 0, 40, 30).pixels, expected)
        assert source.pages == 1
        assert "not kept: frames after the first" in source.notes
    with pytest.raises(UsageError, match="no page 2"):
        open_source(data, page=2)


ASSOCIATED = 45
"""The bit of a header of 40×30 pixels of 16 bits with alpha that says whether colours are multiplied by it: behind 15
bits of its size, 14 of samples and their number, 16 of what alpha is.
"""


def test_colours_that_are_multiplied_by_alpha() -> None:
    pixels = np.random.default_rng(2).integers(0, 9000, (30, 40, 4)).astype(np.uint16)
    pixels[..., 3] = 65535
    pixels[:9, :, 3] = 20000
    data = imagecodecs.jpegxl_encode(pixels, lossless=True, usecontainer=True)
    at = data.index(b"\xff\x0a", 20) + 2 + ASSOCIATED // 8
    stated = bytes([data[at] | 1 << ASSOCIATED % 8])
    with open_source(data[:at] + stated + data[at + 1 :]) as source:
        found = source.read(0, 0, 40, 30).pixels
    np.testing.assert_array_equal(found[9:], pixels[9:])
    np.testing.assert_array_equal(found[:9, :, :3], np.rint(pixels[:9, :, :3] * (65535 / 20000)))


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float32"])
def test_gray_with_alpha(dtype: str) -> None:
    pixels = np.random.default_rng(6).integers(0, 2, (30, 40, 2)).astype(dtype)
    picture = read(imagecodecs.jpegxl_encode(pixels, lossless=True))
    assert picture.channels == "gray+alpha"
    np.testing.assert_array_equal(picture.pixels, pixels)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_channels_that_openimageio_makes_up_are_refused(count: int) -> None:
    planes = np.random.default_rng(3).integers(0, 256, (1 + count, 30, 40)).astype(np.uint8)
    data = imagecodecs.jpegxl_encode(planes, lossless=True, planar=True, photometric="gray")
    with pytest.raises(PictureError, match=f"it has {count} channels? beside colours, .*, which are not read"):
        open_source(data)


@pytest.mark.parametrize(
    ("bits", "notes"), [(12, ("samples v of its 12 bits become 16 bits, v · 65535 / 4095 rounded",)), (16, ())]
)
def test_that_few_bits_are_stretched_is_said(bits: int, notes: tuple[str, ...]) -> None:
    pixels = np.random.default_rng(5).integers(0, 1 << bits, (30, 40, 3)).astype(np.uint16)
    data = imagecodecs.jpegxl_encode(pixels, lossless=True, bitspersample=bits)
    with open_source(data) as source:
        assert source.notes == notes
        expected = np.rint(pixels * (65535 / ((1 << bits) - 1)))
        np.testing.assert_allclose(source.read(0, 0, 40, 30).pixels, expected, rtol=0, atol=1)


def test_metadata_comes_and_the_picture_is_upright_already(tmp_path: Path) -> None:
    blob = exif_blob()
    more = box(b"Exif", bytes(4) + blob), box(b"xml ", b"<x:xmpmeta/>"), box(b"Exif", b"second")
    with open_source(boxed(tmp_path / "a.jxl", *more)) as source:
        found = source.read(0, 0, source.width, source.height)
        assert (source.width, source.height, source.notes) == (40, 30, ())
    np.testing.assert_array_equal(found.pixels, PIXELS)
    assert found.metadata.xmp == b"<x:xmpmeta/>"
    assert b"Maker" in found.metadata.exif
    assert exif.orientation(found.metadata.exif) == 1


def test_metadata_is_decompressed(tmp_path: Path) -> None:
    more = (brotli(b"xml ", b"<x:xmpmeta/>"), brotli(b"jumb", b"another"), brotli(b"Exif", bytes(4) + exif_blob()))
    with open_source(boxed(tmp_path / "a.jxl", *more)) as source:
        assert source.notes == ()
        assert source.metadata.xmp == b"<x:xmpmeta/>"
        assert b"Maker" in source.metadata.exif


@pytest.mark.parametrize("contents", [b"damaged", imagecodecs.brotli_encode(bytes(1 << 25))])
def test_what_is_damaged_or_swells_is_said(contents: bytes, tmp_path: Path) -> None:
    with open_source(boxed(tmp_path / "a.jxl", box(b"brob", b"xml " + contents))) as source:
        assert source.metadata.xmp is None
        assert source.notes == (NOT_READ,)


def test_without_the_library_it_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "imagecodecs", None)
    with open_source(boxed(tmp_path / "a.jxl", brotli(b"Exif", bytes(4) + exif_blob()))) as source:
        assert source.metadata.exif is None
        assert source.notes == (NOT_READ,)


def test_an_animation_without_the_library_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    data = imagecodecs.jpegxl_encode(np.stack([PIXELS, PIXELS]), photometric="rgb")
    monkeypatch.setitem(sys.modules, "imagecodecs", None)
    with pytest.raises(PictureError, match="it is an animation; reading its first frame needs imagecodecs"):
        open_source(data)


@pytest.mark.parametrize("cut", [36, 50])
def test_of_a_file_that_is_cut_off_what_stands_before_is_read(cut: int, tmp_path: Path) -> None:
    whole = boxed(tmp_path / "a.jxl", box(b"xml ", b"<x/>")).read_bytes()
    assert find(whole[:cut]) == (None, b"<x/>" if cut > 44 else None)
