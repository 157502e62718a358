from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from data_files import PICTURES
from image_files import packed
from PIL import Image
from tags import doubles, exif_blob, exif_of, shorts, text

from sgicodec import read
from sgicodec.errors import PictureError
from sgicodec.metadata import embedded, ifd, orientation
from sgicodec.metadata import jpeg as jpeg_file
from sgicodec.metadata import png as png_file
from sgicodec.metadata import webp as webp_file
from sgicodec.picture import Metadata, Picture

HOLDERS = ["jpeg", "png", "tiff", "webp"]
XMP = b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><odd:Thing xmlns:odd="urn:x">\xc3\xa4</odd:Thing></x:xmpmeta>'


def _flat(metadata: Metadata, count: int = 3) -> Picture:
    pixels = np.full((9, 17, count), 100, np.uint8)
    return Picture(pixels, {3: "rgb", 4: "rgba"}[count], (0.0, 255.0), metadata)


@pytest.mark.parametrize("format", HOLDERS)
def test_all_metadata_comes_back(format: str) -> None:
    icc = read(PICTURES / "icc_profile.png").metadata.icc
    written = Metadata(icc, exif_blob(orientation=1), XMP)
    back = read(packed(_flat(written), format)).metadata
    assert (back.icc, back.xmp) == (icc, XMP)
    assert back.exif is not None
    assert written.exif is not None
    expected = ifd.load(written.exif)
    if format == "tiff":
        expected.pop(274)
    else:
        assert back.exif == written.exif
    assert ifd.load(back.exif) == expected


@pytest.mark.parametrize("format", HOLDERS)
@pytest.mark.parametrize("name", ["exif_gps.jpg", "pil_sample_cmyk.jpg"])
def test_camera_exif_survives(format: str, name: str) -> None:
    source = read(PICTURES / name)
    back = read(packed(source, format))
    assert back.metadata.xmp == source.metadata.xmp
    assert source.metadata.exif is not None
    assert back.metadata.exif is not None
    kept, expected = ifd.load(back.metadata.exif), ifd.load(source.metadata.exif)
    assert kept.keys() >= expected.keys() & {271, 272, 305, 306, ifd.EXIF_IFD, ifd.GPS_IFD}
    for tag in kept:
        assert kept[tag] == expected[tag]


def test_own_tags_of_exif_become_tags_of_a_tiff() -> None:
    """But not what says how pixels of another file are stored, or where it lay."""
    own = {4096: text("mine"), 50341: text("PrintIM"), 18249: shorts(99)}
    exif = exif_of({**own, 258: shorts(5), 531: shorts(2), 33550: doubles(2, 2, 0), 305: text("x")})
    data = packed(_flat(Metadata(exif=exif)), "tiff")
    stored = ifd.load(data)
    assert {tag: stored[tag] for tag in own} == own
    assert stored[258] != shorts(5)
    assert not stored.keys() & {531, 33550}


PLACES = [
    "jpeg",
    "jpeg late",
    "png",
    "png late",
    "png prefix",
    "webp",
    "webp prefix",
    "raw profile",
    "raw profile late",
]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("turn", [3, 6, 8])
def test_an_orientation_is_applied_once(place: str, turn: int) -> None:
    ramp = np.arange(9 * 17, dtype=np.uint8).reshape(9, 17, 1).repeat(3, 2)
    picture = Picture(ramp, "rgb", (0.0, 255.0))
    format, _, how = place.replace("raw profile", "png raw").partition(" ")
    turned = (b"Exif\0\0" if "prefix" in how else b"") + exif_blob(orientation=turn)
    plain = packed(picture, format)
    if format == "png":
        digits = (b"Exif\0\0" + turned).hex().encode()
        text = b"Raw profile type exif\0\nexif\n      %d\n%s\n" % (len(turned) + 6, digits)
        chunk = png_file.chunk(b"tEXt", text) if "raw" in how else png_file.chunk(b"eXIf", turned)
        at = len(plain) - 12 if "late" in how else 33
        data = plain[:at] + chunk + plain[at:]
    elif how == "late":
        data = (
            plain[:2] + b"\xff\xfe\0\4xx\xff\xff\xff\xff" + b"".join(jpeg_file.insert(plain, Metadata(exif=turned)))[2:]
        )
    else:
        data = b"".join({"jpeg": jpeg_file, "webp": webp_file}[format].insert(plain, Metadata(exif=turned)))
    once = read(data)
    upright = orientation.upright(ramp, turn)
    assert once.pixels.shape == upright.shape
    assert (np.abs(once.pixels.astype(int) - upright) <= 2).all()
    assert once.metadata.exif == exif_blob(orientation=1)
    for format in HOLDERS[1:]:
        twice = read(packed(once, format))
        np.testing.assert_array_equal(twice.pixels, once.pixels)


def test_compressed_png_text_and_its_limits() -> None:
    text = png_file.chunk(b"iTXt", b"XML:com.adobe.xmp\0\1\0\0\0" + zlib.compress(XMP))
    plain = packed(_flat(Metadata()), "png")
    assert png_file.find(plain[:33] + text + plain[33:]) == (None, XMP, None)
    broken = png_file.chunk(b"zTXt", b"Raw profile type exif\0\0garbage")
    assert png_file.find(plain[:33] + broken + plain[33:]) == (None, None, None)


def test_what_lies_behind_a_png_is_no_part_of_it() -> None:
    """Another picture with metadata of its own, or zeros, of which twelve look like an empty chunk."""
    bare, other = io.BytesIO(), io.BytesIO()
    Image.new("L", (4, 4)).save(bare, "png")
    Image.new("L", (4, 4)).save(other, "png", exif=Image.Exif(), dpi=(300, 300))
    for more in (other.getvalue()[8:], bytes(240)):
        data = bare.getvalue() + more
        assert [kind for kind, _, _ in png_file.chunks(data)] == [b"IHDR", b"IDAT", b"IEND"]
        assert png_file.find(data) == png_file.find(bare.getvalue())


def test_more_than_a_jpeg_segment_holds() -> None:
    most = exif_blob(1) + bytes(65527 - len(exif_blob(1)))
    assert read(packed(_flat(Metadata(exif=most)), "jpeg")).metadata.exif == most
    with pytest.raises(PictureError, match="jpeg cannot hold 65528 bytes of EXIF, only 65527"):
        packed(_flat(Metadata(exif=most + b"\0")), "jpeg")
    assert read(packed(_flat(Metadata(exif=most + b"\0")), "png")).metadata.exif == most + b"\0"


def _by_pillow(data: bytes) -> tuple[bytes | None, bytes | None]:
    with pytest.importorskip("PIL.Image").open(io.BytesIO(data)) as other:
        blob = other.info.get("exif")
        return blob and blob.removeprefix(b"Exif\0\0"), other.info.get("xmp")


def test_pillow_finds_the_same_bytes() -> None:
    """Those before the pixels, in whatever the repository has of these formats and in what is written."""
    files = [path.read_bytes() for path in sorted(PICTURES.glob("*.[jp][pn]g")) if not path.name.startswith("x")]
    files += [path.read_bytes() for path in sorted(PICTURES.glob("x*.jpg"))]
    files += [packed(_flat(Metadata(exif=exif_blob(1), xmp=XMP)), format) for format in ("jpeg", "png", "webp")]
    plain = packed(_flat(Metadata()), "jpeg")
    segment = b"\xff\xff\xff\xe1" + struct.pack(">H", 8 + len(exif_blob(6))) + b"Exif\0\0" + exif_blob(6)
    files.append(plain[:2] + segment + plain[2:])
    assert len(files) > 15
    for data in files:
        found = embedded.extract(data)
        assert (found.exif, found.xmp) == _by_pillow(data)
