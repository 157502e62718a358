from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from data_files import PICTURES
from image_files import by_pillow, by_tifffile, noise, notes_of
from PIL import Image

from sgicodec import read, write
from sgicodec.errors import PictureError
from sgicodec.image.alpha import unassociate
from sgicodec.image.reader import probe
from sgicodec.metadata import geo
from sgicodec.metadata.png import chunk
from sgicodec.picture import Metadata, Picture

ODD = {
    "16bit.cropped.tif": ((64, 64, 1), "uint16", "gray"),
    "1_trns.png": ((64, 64, 2), "uint8", "gray+alpha"),
    "basn0g01.png": ((32, 32, 1), "uint8", "gray"),
    "basn0g16.png": ((32, 32, 1), "uint16", "gray"),
    "basn2c08.png": ((32, 32, 3), "uint8", "rgb"),
    "basn2c16.png": ((32, 32, 3), "uint16", "rgb"),
    "basn3p02.png": ((32, 32, 3), "uint8", "rgb"),
    "basn4a08.png": ((32, 32, 2), "uint8", "gray+alpha"),
    "basn4a16.png": ((32, 32, 2), "uint16", "gray+alpha"),
    "basn6a16.png": ((32, 32, 4), "uint16", "rgba"),
    "exif_gps.jpg": ((8, 8, 3), "uint8", "rgb"),
    "hopper.sgi": ((128, 128, 3), "uint8", "rgb"),
    "hopper_1bit.pbm": ((128, 128, 1), "uint8", "gray"),
    "hopper_gray.jpg": ((128, 128, 1), "uint8", "gray"),
    "hopper_orientation_6.jpg": ((128, 128, 3), "uint8", "rgb"),
    "icc_profile.png": ((57, 57, 4), "uint8", "rgba"),
    "la.tga": ((64, 64, 2), "uint8", "gray+alpha"),
    "pil_sample_cmyk.jpg": ((100, 100, 3), "uint8", "rgb"),
    "rgb_trns.png": ((64, 64, 4), "uint8", "rgba"),
    "s01n3p01.png": ((1, 1, 3), "uint8", "rgb"),
    "s03n3p01.png": ((3, 3, 3), "uint8", "rgb"),
    "tRNS_null_1x1.png": ((1, 1, 4), "uint8", "rgba"),
    "tiff_16bit_RGBa.tiff": ((40, 100, 4), "uint16", "rgba"),
    "xmp_padded.jpg": ((1, 1, 3), "uint8", "rgb"),
}

DAMAGED = {
    "corrupt_rle.sgi": "Corrupt RLE",
    "truncated_jpeg.jpg": "Premature end",
    "xcsn0g01.png": "IDAT at byte 49 is damaged",
    "xdtn0g01.png": "IDAT is missing",
    "xhdn0g08.png": "IHDR at byte 8 is damaged",
    "xlfn0g04.png": "Not a PNG",
    "xs1n0g01.png": "Not a PNG",
}


@pytest.mark.parametrize("name", ODD)
def test_odd_pictures(name: str) -> None:
    shape, dtype, channels = ODD[name]
    picture = read(PICTURES / name)
    assert (picture.pixels.shape, picture.pixels.dtype.name, picture.channels) == (shape, dtype, channels)
    header = probe(PICTURES / name)
    assert (header.height, header.width, header.count) == shape
    assert (header.dtype, header.channels) == (picture.pixels.dtype, channels)


@pytest.mark.parametrize(
    ("name", "mode"),
    [
        ("1_trns.png", "LA"),
        ("basn0g01.png", "L"),
        ("basn2c08.png", "RGB"),
        ("basn3p02.png", "RGB"),
        ("basn4a08.png", "LA"),
        ("hopper.sgi", "RGB"),
        ("hopper_1bit.pbm", "L"),
        ("hopper_gray.jpg", "L"),
        ("icc_profile.png", "RGBA"),
        ("la.tga", "LA"),
        ("rgb_trns.png", "RGBA"),
        ("s03n3p01.png", "RGB"),
    ],
)
def test_pixels_are_what_another_reader_sees(name: str, mode: str) -> None:
    with Image.open(PICTURES / name) as other:
        expected = np.asarray(other.convert(mode))
    np.testing.assert_array_equal(read(PICTURES / name).pixels, expected.reshape(*expected.shape[:2], -1))


@pytest.mark.parametrize("name", DAMAGED)
def test_damage_is_refused_in_one_line_that_names_the_file(name: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(PictureError) as caught:
        read(PICTURES / name)
    message = str(caught.value)
    assert message.startswith(str(PICTURES / name))
    assert DAMAGED[name] in message
    assert "\n" not in message
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    "name", ["basn2c16.png", "hopper.sgi", "hopper_gray.jpg", "hopper_1bit.pbm", "tiff_16bit_RGBa.tiff"]
)
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.99])
def test_files_cut_anywhere_are_refused(name: str, share: float, capfd: pytest.CaptureFixture[str]) -> None:
    data = (PICTURES / name).read_bytes()
    with pytest.raises(PictureError):
        read(data[: int(share * len(data))])
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "empty"),
        (b"not a picture at all\n" * 20, "no picture format"),
        (b"\x89SGI\r\n\x1a\n" + bytes(40), "decode it first"),
        (b"\x89PNG\r\n\x1a\n", "cut off in the PNG chunk header"),
    ],
)
def test_what_is_no_picture(data: bytes, reason: str) -> None:
    with pytest.raises(PictureError, match=f"the picture: .*{reason}"):
        read(data)
    with pytest.raises(PictureError, match=reason):
        probe(io.BytesIO(data))


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(PictureError, match=r"gone\.png: No such file"):
        read(tmp_path / "gone.png")
    with pytest.raises(PictureError, match="Is a directory"):
        read(tmp_path)


NAMES = (
    "tif",
    "png",
    "null",
    "jpeg2000",
    "x.null",
    "x.NUL",
    "x.null?a=1",
    "x.ndpi",
    "x.czi",
    "x.mrxs",
    "x.exr",
    "a%04d.png",
)


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "GIF", "BMP", "TGA", "QOI", "PCX", "AVIF"])
def test_content_counts_and_not_the_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    data = by_pillow(Image.new("RGB", (12, 7), (200, 100, 50)), kind)
    monkeypatch.chdir(tmp_path)
    for name in NAMES:
        Path(name).write_bytes(data)
        picture = read(name)
        assert (picture.width, picture.height) == (12, 7), name
        np.testing.assert_allclose(picture.pixels[3, 5, :3], [200, 100, 50], atol=3, err_msg=name)


def test_a_png_of_an_iphone_is_named() -> None:
    with pytest.raises(PictureError, match=r"chunk CgBI.* pngcrush -revert-iphone-optimizations IN a\.png$"):
        read(_png(b"CgBI", b"\x50\0\x20\2"))


def test_more_samples_than_allowed() -> None:
    assert read(PICTURES / "basn2c08.png", max_samples=32 * 32 * 3).width == 32
    with pytest.raises(PictureError, match=r"32 × 32 pixels of 3 channels .* 3071 samples"):
        read(PICTURES / "basn2c08.png", max_samples=32 * 32 * 3 - 1)


def test_a_huge_header_takes_no_memory() -> None:
    with pytest.raises(PictureError, match=r"more than the cap|claims a \d+ MB image"):
        read(_png(b"tEXt", b"a\0b", width=60000, height=60000))


XMP = b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:Description tiff:Orientation="%d"/></x:xmpmeta>'


@pytest.mark.parametrize("extension", ["png", "webp", "jpg"])
def test_orientation_that_stands_in_xmp_alone_is_applied(tmp_path: Path, extension: str) -> None:
    path = tmp_path / f"x.{extension}"
    stored = np.repeat(noise(3, 5, 1, "uint8"), 3, axis=2)
    write(Picture(stored, "rgb", (0.0, 255.0), Metadata(xmp=XMP % 6)), path)
    picture = read(path)
    assert picture.metadata.xmp == XMP % 1
    assert picture.pixels.shape == (5, 3, 3)
    if extension != "jpg":
        np.testing.assert_array_equal(picture.pixels, np.rot90(stored, -1))


def test_associated_alpha_is_divided_out() -> None:
    path = PICTURES / "tiff_16bit_RGBa.tiff"
    stored = oiio.ImageInput.open(str(path)).read_image("uint16").astype(np.float64)
    pixels = read(path).pixels
    np.testing.assert_array_equal(pixels[..., 3], stored[..., 3])
    visible = stored[..., 3] > 0
    expected = (stored[..., :3] * 65535 / np.maximum(stored[..., 3:], 1))[visible]
    np.testing.assert_allclose(pixels[..., :3][visible], expected, atol=0.5)
    np.testing.assert_array_equal(pixels[~visible], stored[~visible])


@pytest.mark.parametrize("turn", [1, 6])
def test_rational_polynomials_do_not_turn(turn: int) -> None:
    tags = [(50844, "d", 92, (0.5, *[1.0] * 91), True), (274, "H", 1, turn, True)]
    data = by_tifffile(np.zeros((8, 9), np.uint8), photometric="minisblack", metadata=None, extratags=tags)
    assert notes_of(data) == (("not kept: RPC, for it is turned",) if turn > 1 else ())
    assert (geo.RPC in geo.load(read(data).metadata.geo)) == (turn == 1)


def test_a_profile_for_other_channels_is_left_behind() -> None:
    profile = read(PICTURES / "icc_profile.png").metadata.icc
    assert profile is not None
    for space, kept in ((b"RGB ", True), (b"CMYK", False), (b"GRAY", False)):
        packed = zlib.compress(profile[:16] + space + profile[20:])
        assert (read(_png(b"iCCP", b"x\0\0" + packed)).metadata.icc is not None) == kept


def _png(kind: bytes, contents: bytes, width: int = 1, height: int = 1) -> bytes:
    """A PNG file of one RGB pixel, whatever its header says, with one chunk more."""
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    data = chunk(b"IDAT", zlib.compress(b"\0\1\2\3"))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(kind, contents) + data + chunk(b"IEND", b"")


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
def test_integers_come_back_when_multiplied_again(dtype: str) -> None:
    largest = int(np.iinfo(dtype).max)
    random = np.random.default_rng(1)
    alpha = random.integers(1, largest, 4000, endpoint=True)
    colour = random.integers(0, alpha, endpoint=True)
    divided = unassociate(np.stack([colour, alpha], -1).astype(dtype)[None])
    again = np.rint(divided[0, :, 0].astype(np.float64) * alpha / largest)
    np.testing.assert_array_equal(again, colour)
    np.testing.assert_array_equal(divided[0, :, 1], alpha)


def test_brighter_than_alpha_is_clipped_and_no_alpha_keeps_its_colour() -> None:
    pixels = np.array([[[200, 100], [77, 0], [0, 9]]], np.uint8)
    assert unassociate(pixels)[0].tolist() == [[255, 100], [77, 0], [0, 9]]
    assert pixels[0, 0, 0] == 200
