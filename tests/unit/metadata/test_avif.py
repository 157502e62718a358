"""Boxes of AVIF: what they say of the primary picture; any bytes are read or refused."""

from __future__ import annotations

import struct
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from image_files import by_pillow

from sgicodec.errors import PictureError
from sgicodec.metadata.avif import Still, still
from sgicodec.metadata.left_behind import left_behind


def box(kind: bytes, *contents: bytes) -> bytes:
    body = b"".join(contents)
    return struct.pack(">I4s", 8 + len(body), kind) + body


SIZE = box(b"ispe", bytes(4), struct.pack(">II", 60, 40))


def configuration(flags: int) -> bytes:
    return box(b"av1C", bytes([0x81, 0, flags, 0]))


REAL = by_pillow(np.zeros((6, 8, 3), np.uint8), "AVIF", speed=10)


def crop(*fields: int) -> bytes:
    return box(b"clap", struct.pack(">IIIIiIiI", *fields))


def file(*properties: bytes, version: int = 0, wide: bool = False, own: int | None = None, items: bytes = b"") -> bytes:
    """A file of two pictures, the second of which is the primary one and has the first `own` properties, or all. items:
    a box that lists what there is.
    """
    count = len(properties) if own is None else own
    item, number = ">I" if version else ">H", ">H" if wide else ">B"
    essential = 0x8000 if wide else 0x80
    rows = b"".join(
        struct.pack(item, name) + bytes([len(listed)]) + b"".join(struct.pack(number, value) for value in listed)
        for name, listed in ((1, [1]), (2, [essential | at for at in range(1, count + 1)]))
    )
    associations = box(b"ipma", bytes([version, 0, 0, int(wide)]), struct.pack(">I", 2), rows)
    primary = box(b"pitm", bytes([version, 0, 0, 0]), struct.pack(item, 2))
    meta = box(b"meta", bytes(4), primary, items, box(b"iprp", box(b"ipco", *properties), associations))
    return box(b"ftyp", b"avif", bytes(4), b"avifmif1") + meta + box(b"mdat", bytes(10))


@pytest.mark.parametrize("version", [0, 1])
@pytest.mark.parametrize("wide", [False, True])
@pytest.mark.parametrize(("flags", "bits", "is_gray"), [(0x0C, 8, False), (0x4C, 10, False), (0x70, 12, True)])
def test_depth_and_size(version: int, wide: bool, flags: int, bits: int, is_gray: bool) -> None:
    data = file(SIZE, configuration(flags), version=version, wide=wide)
    assert still(data) == Still(60, 40, bits, is_gray, (0, 0, 60, 40), 1)


def items(*kinds: bytes, version: int = 0) -> bytes:
    count, number = (">I", ">I") if version else (">H", ">H")
    entries = [
        box(b"infe", bytes([2 + version, 0, 0, 0]), struct.pack(number, at), bytes(2), kind, b"\0")
        for at, kind in enumerate(kinds)
    ]
    return box(b"iinf", bytes([version, 0, 0, 0]), struct.pack(count, len(kinds)), *entries)


@pytest.mark.parametrize(
    ("listed", "more", "is_said"),
    [
        (items(b"av01", b"Exif"), (), False),
        (items(b"av01", b"tmap"), (), True),
        (items(b"av01", b"tmap", version=1), (), True),
        (b"", (box(b"auxC", bytes(4), b"urn:mpeg:mpegB:cicp:systems:auxiliary:alpha\0"),), False),
        (b"", (box(b"auxC", bytes(4), b"urn:mpeg:mpegB:cicp:systems:auxiliary:depth\0"),), True),
    ],
)
def test_further_pictures_are_said(listed: bytes, more: tuple[bytes, ...], is_said: bool) -> None:
    data = file(SIZE, configuration(0), *more, items=listed)
    assert left_behind(data) == ["further pictures (a gain map, depth)"] * is_said


def test_crop_and_turn() -> None:
    data = file(SIZE, configuration(0), crop(31, 1, 20, 1, -9, 2, 2, 1), box(b"irot", b"\3"), box(b"imir", b"\1"))
    assert still(data) == Still(60, 40, 8, False, (10, 12, 31, 20), 5)


@pytest.mark.parametrize(
    ("properties", "complaint"),
    [
        ((SIZE,), "its samples are not of AV1"),
        ((configuration(0),), "its boxes do not hold what they must"),
        ((SIZE, configuration(0), crop(31, 1, 20, 1, 0, 1, 0, 1)), "its crop is not one of whole pixels"),
        ((SIZE, configuration(0), crop(30, 1, 20, 1, 40, 1, 0, 1)), "its crop is not one of whole pixels"),
        ((SIZE, configuration(0), crop(0, 1, 20, 1, 0, 1, 0, 1)), "its crop is not one of whole pixels"),
        ((SIZE, configuration(0), crop(30, 0, 20, 1, 0, 1, 0, 1)), "its boxes do not hold what they must"),
        ((SIZE, configuration(0), box(b"imir", b"\0"), box(b"irot", b"\1")), "in another order"),
        ((SIZE, configuration(0), box(b"irot", b"\1"), box(b"irot", b"\1")), "in another order"),
    ],
)
def test_what_is_not_read_is_refused(properties: tuple[bytes, ...], complaint: str) -> None:
    with pytest.raises(PictureError, match=complaint):
        still(file(*properties))


@given(at=st.integers(0, 400), value=st.integers(0, 255))
def test_any_byte_may_be_wrong(at: int, value: int) -> None:
    data = bytearray(REAL)
    data[at % len(data)] = value
    with suppress(PictureError):
        assert still(bytes(data)).bits in (8, 10, 12)
