from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from image_files import by_pillow
from tags import exif_blob

from sgicodec import read
from sgicodec.metadata import jpeg

PLAIN = by_pillow(np.arange(24 * 32, dtype=np.uint8).reshape(24, 32), "JPEG")
XMP = b"http://ns.adobe.com/xap/1.0/\0"
PACKET = b"<x:xmpmeta xmlns:x='adobe:ns:meta/'/>"


def segment(payload: bytes, marker: int = 0xE1) -> bytes:
    return struct.pack(">BBH", 0xFF, marker, len(payload) + 2) + payload


@pytest.mark.parametrize(
    "before",
    [
        b"",
        b"\xff\xff",
        b"\xff" * 70000,
        b"\xff\x01",
        b"\0\0\xff\0",
        segment(b"a comment", 0xFE),
        segment(b"Photoshop 3.0\0", 0xED) + b"\xff" + segment(b"MPF\0", 0xE2) + b"\xff\xff\xff",
        segment(b"http://ns.example/\0other"),
        segment(XMP + PACKET) + b"\xff",
    ],
)
@pytest.mark.parametrize("at", [2, 20])
def test_what_may_stand_before_a_segment(before: bytes, at: int) -> None:
    blob = exif_blob(orientation=6)
    whole = PLAIN[:at] + before + segment(b"Exif\0\0" + blob) + b"\xff" + segment(XMP + PACKET) + PLAIN[at:]
    assert jpeg.find(whole) == (blob, PACKET, None)
    if b"\0" not in before[:1]:
        picture = read(whole)
        assert picture.pixels.shape == (32, 24, 1)
        assert picture.metadata.exif == exif_blob(orientation=1)


@given(st.binary(max_size=60))
def test_damage_raises_nothing(tail: bytes) -> None:
    for head in (b"\xff\xd8\xff", b"\xff\xd8\xff\xe0\0\x10JFIF\0"):
        assert len(jpeg.find(head + tail)) == 3
