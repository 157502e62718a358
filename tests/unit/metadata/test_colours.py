"""Colours of files: ICC profiles that fit, those that are named instead, and what is said without a profile."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from image_files import SRGB, by_pillow, by_tifffile, notes_of
from PIL import Image, ImageCms

from sgicodec import open_source
from sgicodec.errors import PictureError
from sgicodec.image.conversion import as_picture
from sgicodec.metadata.icc import fitting
from sgicodec.metadata.left_behind import left_behind
from sgicodec.metadata.png import chunk

LAB = ImageCms.ImageCmsProfile(ImageCms.createProfile("LAB")).tobytes()
PIXELS = np.arange(36, dtype=np.uint8).reshape(3, 4, 3)
OTHER, DAMAGED = "ICC profile (of another colour space)", "ICC profile (damaged)"


def bmp(profile: bytes) -> bytes:
    """One of version 5."""
    plain = by_pillow(PIXELS, "BMP")
    masks = (
        plain[18:38]
        + bytes(8)
        + plain[46:54]
        + bytes(16)
        + b"DEBM"
        + bytes(48)
        + struct.pack("<IIII", 4, 124 + 36, len(profile), 0)
    )
    head = struct.pack("<2sIHHII", b"BM", 138 + 36 + len(profile), 0, 0, 138, 124)
    return head + masks + plain[54:] + profile


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "TIFF", "WEBP", "AVIF", "BMP"])
@pytest.mark.parametrize(
    ("profile", "said"),
    [(SRGB, ()), (SRGB[:-99], (DAMAGED,)), (b"nothing" * 30, (DAMAGED,)), (LAB, (OTHER,))],
    ids=["whole", "cut", "none", "lab"],
)
def test_a_profile_that_does_not_fit_is_named(kind: str, profile: bytes, said: tuple[str, ...]) -> None:
    with open_source(bmp(profile) if kind == "BMP" else by_pillow(PIXELS, kind, icc_profile=profile)) as source:
        assert source.notes == tuple(f"not kept: {text}" for text in said)
        assert source.metadata.icc == (None if said else profile)


def test_a_profile_of_colours_beside_gray() -> None:
    for kind in ("JPEG", "PNG"):
        assert notes_of(by_pillow(PIXELS[..., 0], kind, icc_profile=SRGB)) == (f"not kept: {OTHER}",)
    image = Image.fromarray(PIXELS[..., 0])
    image.info["icc_profile"] = SRGB
    assert as_picture(image).remark == f"not kept: {OTHER}"
    assert fitting(SRGB, "multi") == (SRGB, None)


def test_a_chunk_that_cannot_be_unpacked() -> None:
    plain = by_pillow(PIXELS, "PNG")
    for packed in (b"x", zlib.compress(SRGB)[:50]):
        assert notes_of(plain[:33] + chunk(b"iCCP", b"a\0\0" + packed) + plain[33:]) == (f"not kept: {DAMAGED}",)


WHITE, PRIMARIES = (3127, 10000, 3290, 10000), (64, 100, 33, 100, 30, 100, 60, 100, 15, 100, 6, 100)
POWER, LINEAR = (tuple(round(65535 * (at / 255) ** power) for at in range(256)) for power in (2.2, 1.0))


def tiff(*tags: tuple[int, int, int, tuple[int, ...], bool]) -> bytes:
    return by_tifffile(PIXELS, photometric="rgb", metadata=None, extratags=tags)


def stated_bmp(version: int, kind: bytes, gamma: int = 0) -> bytes:
    plain = by_pillow(PIXELS, "BMP")
    head = struct.pack("<I", version) + plain[18:54] + bytes(16) + kind
    return plain[:14] + head.ljust(version - 4, b"\0") + struct.pack("<I", gamma) + plain[54:]


def hdr(*lines: str) -> bytes:
    text = "\n".join(["#?RADIANCE", "# EXPOSURE=9", "SOFTWARE=x", *lines, "", "-Y 1 +X 8", ""])
    return text.encode() + bytes([90, 80, 70, 128] * 8)


@pytest.mark.parametrize(
    ("data", "names"),
    [
        (tiff((318, 5, 2, WHITE, True), (319, 5, 6, PRIMARIES, True)), []),
        (tiff((318, 5, 2, (3457, 10000, 3585, 10000), True)), ["colour space (WhitePoint)"]),
        (tiff((319, 5, 6, (68, *PRIMARIES[1:]), True)), ["colour space (PrimaryChromaticities)"]),
        (tiff((301, 3, 768, POWER * 3, True)), []),
        (tiff((301, 3, 256, LINEAR, True)), ["colour space (TransferFunction)"]),
        (tiff((301, 3, 256, LINEAR, True), (34675, 7, 4, b"icc ", True)), []),
        (stated_bmp(108, b"BGRs", 9), []),
        (stated_bmp(108, bytes(4)), []),
        (stated_bmp(108, bytes(4), 9), ["colour space (calibrated RGB)"]),
        (stated_bmp(124, b"KNIL"), ["ICC profile (in another file)"]),
        (b"qoif" + bytes(8) + b"\3\0", []),
        (b"qoif" + bytes(8) + b"\3\1", ["colour space (linear)"]),
        (hdr("FORMAT=32-bit_rle_rgbe", "EXPOSURE= 1.0", "COLORCORR=1 1 1"), []),
        (hdr("PRIMARIES=.64 .33 .3 .6 .15 .06 .3333 .3333"), []),
        (hdr("PRIMARIES=.68 .32 .265 .69 .15 .06 .3127 .329", "OWNER=me"), ["colour space (PRIMARIES)", "OWNER"]),
        (hdr("EXPOSURE=4", "PIXASPECT=two"), ["EXPOSURE", "PIXASPECT"]),
    ],
)
def test_other_colours_are_named(data: bytes, names: list[str]) -> None:
    assert left_behind(data) == names


def test_radiance_in_xyz_is_refused(tmp_path: Path) -> None:
    for kind in ("rgbe", "xyze"):
        (tmp_path / f"{kind}.hdr").write_bytes(hdr(f"FORMAT=32-bit_rle_{kind}"))
    assert notes_of(tmp_path / "rgbe.hdr") == ()
    with pytest.raises(PictureError, match="its colours are XYZ"):
        open_source(tmp_path / "xyze.hdr")
