"""ICC profiles that fit, and those that are named instead."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest
from image_files import SRGB, by_pillow, notes_of
from PIL import Image, ImageCms

from sgicodec import open_source
from sgicodec.image.conversion import as_picture
from sgicodec.metadata.icc import fitting
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
