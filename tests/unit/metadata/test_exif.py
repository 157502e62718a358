from __future__ import annotations

import struct
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.metadata import exif, ifd, tiff

Blob = Callable[..., bytes]


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_directory_is_read_in_both_byte_orders(exif_blob: Blob, order: str) -> None:
    assert ifd.load(exif_blob(orientation=6, order=order)) == {
        271: ifd.Entry(2, b"Maker\0"),
        274: ifd.Entry(3, b"\6\0"),
        34665: {42036: ifd.Entry(2, b"50m\0")},
    }


def test_values_of_every_width_are_turned_to_little_endian() -> None:
    rows = [
        (1, 3, 2, b"\1\2\3\4"),
        (2, 4, 1, b"\1\2\3\4"),
        (3, 1, 3, b"abc\0"),
        (4, 5, 1, struct.pack(">I", 62)),
    ]
    blob = b"MM\0*" + struct.pack(">IH", 8, 4) + b"".join(struct.pack(">HHI4s", *row) for row in rows)
    blob += bytes(4) + struct.pack(">II", 1, 3)
    assert {tag: entry.data for tag, entry in ifd.load(blob).items() if isinstance(entry, ifd.Entry)} == {
        1: b"\2\1\4\3",
        2: b"\4\3\2\1",
        3: b"abc",
        4: struct.pack("<II", 1, 3),
    }


ENTRIES = st.dictionaries(
    st.integers(1, 30000),
    st.one_of(
        st.binary(min_size=1, max_size=20).map(lambda data: ifd.Entry(2, data)),
        st.lists(st.integers(0, 65535), min_size=1, max_size=5).map(
            lambda values: ifd.Entry(3, struct.pack(f"<{len(values)}H", *values))
        ),
        st.binary(min_size=8, max_size=8).map(lambda data: ifd.Entry(5, data)),
    ),
    min_size=1,
    max_size=6,
)


@given(main=ENTRIES, sub=ENTRIES, gps=ENTRIES, big=st.booleans())
def test_what_is_dumped_loads(main: ifd.Directory, sub: ifd.Directory, gps: ifd.Directory, big: bool) -> None:
    directory: ifd.Directory = {**main, ifd.EXIF_IFD: sub, ifd.GPS_IFD: gps}
    head = b"II+\0\x08\0\0\0" + struct.pack("<Q", 16) if big else b"II*\0" + struct.pack("<I", 8)
    assert ifd.load(head + ifd.dump(directory, len(head), big=big)) == directory


@given(st.binary(max_size=60), st.integers(0, 79))
def test_damaged_blobs_raise_nothing_else(tail: bytes, cut: int) -> None:
    for head in (b"II*\0\x08\0\0\0", b"MM\0*\0\0\0\x08", b"II+\0\x08\0\0\0\x10\0\0\0\0\0\0\0"):
        exif.upright(head + tail)
        assert len(tiff.find(head + tail)) == 3


@pytest.mark.parametrize("order", ["<", ">"])
def test_upright_changes_the_orientation_and_nothing_else(exif_blob: Blob, order: str) -> None:
    blob = exif_blob(orientation=6, order=order)
    assert exif.upright(b"Exif\0\0" + blob) == exif_blob(orientation=1, order=order)


@pytest.mark.parametrize("order", ["<", ">"])
def test_pixels_per_unit_follow_the_scale(order: str) -> None:
    def blob(across: tuple[int, int], down: tuple[int, int]) -> bytes:
        rows = [(271, 2, 6, 62), (282, 5, 1, 68), (283, 5, 1, 76), (296, 3, 1, 3 if order == "<" else 3 << 16)]
        packed = b"".join(struct.pack(order + "HHII", *row) for row in rows)
        head = struct.pack(order + "2sHIH", b"II" if order == "<" else b"MM", 42, 8, 4)
        return head + packed + bytes(4) + b"Maker\0" + struct.pack(order + "IIII", *across, *down)

    assert exif.rescaled(blob((20000, 1), (7, 2)), 4.0, 0.5) == blob((80000, 1), (7, 4))
    assert exif.rescaled(blob((20000, 0), (300, 1)), 4.0, 1 / 3) == blob((20000, 0), (100, 1))
    for end in range(60):
        assert len(exif.rescaled(blob((1, 1), (1, 1))[:end], 2.0, 2.0)) == end


def test_a_damaged_subdirectory_is_left_out(exif_blob: Blob) -> None:
    assert ifd.load(exif_blob()[:-10]).keys() == {271, 274}


def test_a_blob_without_content_is_none() -> None:
    only_orientation = b"II*\0" + struct.pack("<IHHHIHHI", 8, 1, 274, 3, 1, 6, 0, 0)
    assert exif.upright(only_orientation) is None
    assert exif.upright(b"no TIFF") is None
    assert exif.upright(b"II*\0\xff\0\0\0") is None


def test_the_orientation_in_xmp() -> None:
    assert exif.xmp_orientation(b'<a tiff:Orientation="6" b="5">') == 6
    assert exif.xmp_orientation(b"<tiff:Orientation>8</tiff:Orientation>") == 8
    assert exif.xmp_orientation(b'<a tiff:Orientation="9" Orientation="3">') is None
    assert exif.upright_xmp(b'<a tiff:Orientation="6" b="6">') == b'<a tiff:Orientation="1" b="6">'
    element = b"<tiff:Orientation>8</tiff:Orientation>"
    assert exif.upright_xmp(element) == b"<tiff:Orientation>1</tiff:Orientation>"
