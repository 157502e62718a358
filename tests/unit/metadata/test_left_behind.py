"""What a stream does not keep of a picture file is named."""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from image_files import by_pillow, by_tifffile
from PIL import Image, PngImagePlugin
from tags import exif_of, text

from sgicodec.metadata.filebytes import FileBytes
from sgicodec.metadata.left_behind import left_behind
from sgicodec.metadata.png import chunk

PIXELS = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)


def saved(kind: str, mode: str = "RGB", **options: Any) -> bytes:
    return by_pillow(Image.fromarray(PIXELS).convert(mode), kind, **options)


def png(*chunks: bytes) -> bytes:
    """A PNG with more chunks before its pixels."""
    plain = saved("png")
    return plain[:33] + b"".join(chunks) + plain[33:]


def texts(**given: str) -> bytes:
    info = PngImagePlugin.PngInfo()
    for keyword, value in given.items():
        info.add_text(keyword.replace("_", " "), value)
    return saved("png", pnginfo=info)


def jpeg(marker: int, *payloads: bytes) -> bytes:
    """A JPEG with more segments."""
    plain = saved("jpeg")
    more = [struct.pack(">BBH", 0xFF, marker, len(payload) + 2) + payload for payload in payloads]
    return plain[:2] + b"".join(more) + plain[2:]


def tiff(*pages: dict[str, Any]) -> bytes:
    out = io.BytesIO()
    with tifffile.TiffWriter(out) as file:
        for options in pages:
            file.write(PIXELS[..., 0], metadata=None, **options)
    return out.getvalue()


def classes(step: int) -> bytes:
    """A TIFF of classes, whose colours are multiples of this."""
    table = np.arange(256, dtype=np.uint16)[None] * np.full((3, 1), step, np.uint16)
    return tiff({"photometric": "palette", "colormap": table})


def masked() -> bytes:
    """A TIFF whose second page is a mask of the first."""
    out = io.BytesIO(tiff({}, {"subfiletype": 1}))
    with tifffile.TiffFile(out, mode="r+b") as file:
        file.pages[1].tags[254].overwrite(4)
    return out.getvalue()


def described(**options: Any) -> bytes:
    """A TIFF with the description of a stack."""
    return by_tifffile(PIXELS[..., 0], **options)


def inks(kind: int) -> bytes:
    """A TIFF of four inks, which are cyan, magenta, yellow and black (1) or others (2)."""
    tags = [(332, "H", 1, kind, True)]
    return by_tifffile(np.zeros((4, 4, 4), np.uint8), photometric="separated", metadata=None, extratags=tags)


PAGE = ("PageName", "its position on a page")
DAPI: dict[str, Any] = {"axes": "YX", "Channel": {"Name": ["DAPI"], "Color": [255]}, "Plane": {"ExposureTime": [0.1]}}
EXIF = b"Exif\0\0" + exif_of({305: text("x")})
XMP = b"http://ns.adobe.com/xap/1.0/\0<x/>"
GAMMA, LINEAR = (chunk(b"gAMA", struct.pack(">I", value)) for value in (45455, 100000))
PQ = chunk(b"cICP", bytes([9, 16, 0, 1]))


@pytest.mark.parametrize(
    ("data", "names"),
    [
        (png(), []),
        (png(GAMMA), []),
        (png(LINEAR), ["colour space (gAMA, cHRM)"]),
        (png(LINEAR, chunk(b"sRGB", b"\0")), []),
        (
            png(chunk(b"cHRM", struct.pack(">8I", 31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600))),
            ["colour space (gAMA, cHRM)"],
        ),
        (png(PQ, chunk(b"sRGB", b"\0")), ["colour space (cICP)"]),
        (png(chunk(b"cICP", bytes([1, 13, 0, 1])), LINEAR), []),
        (png(chunk(b"cICP", bytes([1, 13, 0, 0]))), ["colour space (cICP)"]),
        (texts(Software="x"), []),
        (texts(Author="A. Painter", Title="Two"), ["texts"]),
        (texts(Raw_profile_type_iptc="\niptc\n 2\n0000\n"), ["IPTC"]),
        (saved("jpeg"), []),
        (saved("jpeg", comment="by hand"), ["a comment"]),
        (saved("jpeg", comment="CREATOR: gd-jpeg v1.0"), []),
        (saved("jpeg", "CMYK"), ["inks (RGB instead)"]),
        (jpeg(0xED, b"Photoshop 3.0\0" + b"8BIM\4\4" + bytes(8)), ["IPTC"]),
        (jpeg(0xED, b"Photoshop 3.0\0" + b"8BIM\4\5" + bytes(8)), []),
        (jpeg(0xE2, b"MPF\0" + bytes(20)), ["further pictures (MPF)"]),
        (jpeg(0xE1, b'http://ns.adobe.com/xap/1.0/\0<x GCamera:MotionPhoto="1"/>'), ["a video (motion photo)"]),
        (jpeg(0xE1, b'http://ns.adobe.com/xap/1.0/\0<x GCamera:MotionPhoto="0"/>'), []),
        (jpeg(0xEB, b"JP\0\1\0\0\0\1\0\0\0\x28jumbc2pa"), ["Content Credentials"]),
        (jpeg(0xE4, b"\1\2\3"), ["APP4"]),
        (jpeg(0xE1, XMP, XMP), ["a second XMP packet"]),
        (jpeg(0xE1, EXIF, EXIF), ["a second EXIF"]),
        (jpeg(0xE1, EXIF, b"Exif\0\0and so on"), []),
        (jpeg(0xE2, b"FPXR\0\1"), ["APP2 (FPXR)"]),
        (jpeg(0xEC, b"Ducky\0\1"), []),
        (jpeg(0xE1, b"http://ns.adobe.com/xmp/extension/\0" + bytes(50)), ["a part of its XMP"]),
        (saved("jpeg", progressive=True) + bytes(9), []),
        (saved("jpeg", progressive=True) + saved("jpeg")[:99], ["99 bytes behind its end"]),
        (
            png(chunk(b"caBX", b"x"), chunk(b"sTER", b"\0"), chunk(b"tIME", bytes(7))),
            ["Content Credentials", "chunk sTER"],
        ),
        (png() + b"more", ["4 bytes behind its end"]),
        (png(chunk(b"sBIT", b"\5\6\5"), chunk(b"bKGD", bytes(6))), ["chunk sBIT"]),
        (b"P5 # of 4\n2 3\n255\n" + bytes(6), []),
        (b"P5 2 3 255\n" + bytes(6) + b"P5 2 3 255\n" + bytes(6), ["17 bytes behind its end"]),
        (b"P6 2 3 256\n" + bytes(36) + b"P6", ["2 bytes behind its end"]),
        (b"P4 9 3\n2 3 4 P4", ["2 bytes behind its end"]),
        (saved("webp") + b"C2PA" + struct.pack("<I", 4) + b"jumb", ["Content Credentials"]),
        (tiff({}), []),
        (tiff({"extratags": [(33723, "B", 4, b"1234", True)]}), ["IPTC"]),
        (tiff({"extratags": [(37724, "B", 4, b"1234", True)]}), ["layers"]),
        (tiff({"extratags": [(50909, "s", 0, "<gmd/>", True)]}), ["GEO_METADATA"]),
        (tiff({"extratags": [(280, "H", 1, 3, True), (281, "H", 1, 200, True)]}), ["MinSampleValue", "MaxSampleValue"]),
        (tiff({"extratags": [(280, "H", 1, 0, True), (281, "H", 1, 255, True)]}), []),
        (tiff({"extratags": [(65000, "H", 1, 3, True)]}), ["1 private tag"]),
        (tiff({"extratags": [(1000, "H", 1, 3, True), (337, "s", 0, "press", True)]}), ["2 other tags"]),
        (tiff({"extratags": [(18249, "H", 1, 99, True)]}), []),
        (tiff({"extratags": [(65000, "H", 1, 3, True), (65535, "s", 0, "a", True)]}), ["2 private tags"]),
        (tiff({"extratags": [(33628, "I", 1, 1, True), (51023, "s", 0, "<Fibics/>", True)]}), ["2 private tags"]),
        (tiff({"extratags": [(32997, "I", 1, 1, True), (33432, "s", 0, "me", True)]}), []),
        (tiff({"extratags": [(50706, "B", 4, b"\1\4\0\0", True), (50708, "s", 0, "Camera", True)]}), []),
        (tiff({"extratags": [(285, "s", 0, "left", True), (287, "2I", 1, (3, 1), True)]}), [*PAGE]),
        (tiff({"extratags": [(286, "2I", 1, (0, 1), True), (287, "2I", 1, (0, 1), True)]}), []),
        (tiff({"extratags": [(291, "H", 256, tuple(range(256)), True)]}), ["GrayResponseCurve"]),
        (tiff({"extratags": [(341, "f", 1, 0.9, True)]}), ["SMaxSampleValue"]),
        (described(imagej=True, metadata={"min": 3, "unit": "um"}, resolution=(2, 2)), []),
        (described(imagej=True, metadata={"cf": 0, "c0": -32768, "c1": 1}), ["ImageJ's cf, c0, c1"]),
        (described(imagej=True, metadata={"Labels": ["x"]}), ["ImageJ's LUTs, overlays or labels"]),
        (described(metadata={"axes": "YX"}), []),
        (described(metadata={"exposure": 3}), ["tifffile's exposure"]),
        (described(ome=True, metadata={"axes": "YX", "PhysicalSizeX": 0.5}), []),
        (described(ome=True, metadata={"axes": "YX", "SignificantBits": 12}), ["OME's SignificantBits"]),
        (described(ome=True, metadata=DAPI), ["OME's Color, ExposureTime, Channel Name"]),
        (inks(1), ["inks (RGB instead)"]),
        (inks(2), ["names of inks"]),
        (masked(), ["a mask"]),
        (classes(257), ["palette (RGB instead)"]),
        (classes(256), ["palette (RGB of 8 bits, rounded down, instead)"]),
        (classes(1), ["palette (RGB instead)"]),
        (classes(255), ["palette (RGB of 8 bits, rounded down, instead)"]),
        (tiff({"extratags": [(320, "H", 768, bytes(1536), True)]}), ["its colour table"]),
        (tiff({}, {"subfiletype": 1}), []),
        (saved("webp"), []),
        (b"no picture", []),
        (png(LINEAR)[:44], []),
    ],
)
def test_what_is_not_kept_is_named(data: bytes, names: list[str], tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(data)
    with (tmp_path / "a").open("rb") as file:
        assert left_behind(FileBytes(file)) == names


def test_colours_that_avif_numbers(tmp_path: Path) -> None:
    """Those of sRGB are what everybody takes them for."""
    data = saved("avif")
    at = data.index(b"nclx") + 4
    for colours, names in (((1, 13), []), ((1, 2), []), ((9, 16), ["colour space (nclx)"])):
        (tmp_path / "a").write_bytes(data[:at] + struct.pack(">2H", *colours) + data[at + 4 :])
        with (tmp_path / "a").open("rb") as file:
            assert left_behind(FileBytes(file)) == names
