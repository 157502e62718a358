from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tags import exif_blob

from sgicodec.metadata import exif, ifd, tiff
from sgicodec.metadata.motion import Motion


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_directory_is_read_in_both_byte_orders(order: str) -> None:
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


@given(st.binary(max_size=60), st.integers(0, 79))
def test_damaged_blobs_raise_nothing_else(tail: bytes, cut: int) -> None:
    for head in (b"II*\0\x08\0\0\0", b"MM\0*\0\0\0\x08", b"II+\0\x08\0\0\0\x10\0\0\0\0\0\0\0"):
        exif.upright(head + tail)
        assert len(tiff.find(head + tail)) == 3


@pytest.mark.parametrize("order", ["<", ">"])
def test_upright_changes_the_orientation_and_nothing_else(order: str) -> None:
    assert exif.upright(b"Exif\0\0" + exif_blob(orientation=6, order=order)) == exif_blob(orientation=1, order=order)


@pytest.mark.parametrize("order", ["<", ">"])
def test_pixels_per_unit_follow_the_scale(order: str) -> None:
    def blob(across: tuple[int, int], down: tuple[int, int]) -> bytes:
        rows = [(271, 2, 6, 62), (282, 5, 1, 68), (283, 5, 1, 76), (296, 3, 1, 3 if order == "<" else 3 << 16)]
        packed = b"".join(struct.pack(order + "HHII", *row) for row in rows)
        head = struct.pack(order + "2sHIH", b"II" if order == "<" else b"MM", 42, 8, 4)
        return head + packed + bytes(4) + b"Maker\0" + struct.pack(order + "IIII", *across, *down)

    def scaled(across: float, down: float) -> Motion:
        return Motion(6, 6, 1, 0, 0, across, down, round(6 * across), round(6 * down))

    assert exif.moved(blob((20000, 1), (7, 2)), scaled(4.0, 0.5)) == blob((80000, 1), (7, 4))
    assert exif.moved(blob((20000, 0), (300, 1)), scaled(4.0, 1 / 3)) == blob((20000, 0), (100, 1))
    assert exif.moved(blob((300, 1), (150, 1)), Motion(6, 6, 6)) == blob((150, 1), (300, 1))
    for end in range(60):
        assert len(exif.moved(blob((1, 1), (1, 1))[:end], scaled(2.0, 2.0))) == end


def photograph(order: str, **tags: list[int]) -> bytes:
    """A blob whose EXIF directory has these tags of shorts, the picture's being 64×48, and a thumbnail's directory."""
    tags = {"t40962": [64], "t40963": [48], **tags}
    rows, behind = b"", b""
    place = 8 + 2 + 2 * 12 + 4 + 2 + 12 * len(tags) + 4
    for tag, values in sorted((int(name[1:]), values) for name, values in tags.items()):
        packed = struct.pack(f"{order}{len(values)}H", *values)
        if len(packed) > 4:
            behind, packed = behind + packed, struct.pack(order + "I", place + len(behind))
        rows += struct.pack(order + "HHI", tag, 3, len(values)) + packed.ljust(4, b"\0")
    head = struct.pack(order + "2sHIH", b"II" if order == "<" else b"MM", 42, 8, 2)
    head += struct.pack(order + "HHI4s", 271, 2, 4, b"Acm\0") + struct.pack(order + "HHII", ifd.EXIF_IFD, 4, 1, 38)
    return head + struct.pack(order + "IH", 0, len(tags)) + rows + struct.pack(order + "I", 0) + behind + b"rest"


AREA, LOCATION = "t37396", "t41492"
REGION = Motion(64, 48, 1, 8, 12, 2, 2, 40, 40)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(
    ("motion", "width", "height", "area", "location"),
    [
        (Motion(64, 48, 6), 48, 64, [27, 10, 6, 8], [45, 5]),
        (Motion(64, 48, 8), 48, 64, [20, 53, 6, 8], [2, 58]),
        (Motion(64, 48, 3), 64, 48, [53, 27, 8, 6], [58, 45]),
        (Motion(64, 48, 2), 64, 48, [53, 20, 8, 6], [58, 2]),
        (Motion(64, 48, 1, 0, 0, 2, 2, 128, 96), 128, 96, [21, 41, 16, 12], [11, 5]),
        (Motion(64, 48, 1, 0, 0, 0.5, 0.25, 32, 12), 32, 12, [5, 5, 4, 2], [2, 0]),
        (REGION, 40, 40, [5, 17, 16, 12], None),
        (Motion(64, 48, 1, 0, 0, 1100, 2, 70400, 96), 70400, 96, [11550, 41, 8800, 12], [6050, 5]),
        (Motion(64, 48, 1), 64, 48, [10, 20, 8, 6], [5, 2]),
    ],
)
def test_sizes_and_places_follow_the_pixels(
    order: str, motion: Motion, width: int, height: int, area: list[int] | None, location: list[int] | None
) -> None:
    blob = photograph(order, **{AREA: [10, 20, 8, 6], LOCATION: [5, 2]})
    found = ifd.load(exif.moved(blob, motion))
    inner = found[ifd.EXIF_IFD]
    assert isinstance(inner, dict)
    kind = (4, "<I") if width > 65535 else (3, "<H")
    expected = {40962: ifd.Entry(kind[0], struct.pack(kind[1], width)), 40963: ifd.Entry(3, struct.pack("<H", height))}
    for name, values in ((AREA, area), (LOCATION, location)):
        if values is not None:
            expected[int(name[1:])] = ifd.Entry(3, struct.pack(f"<{len(values)}H", *values))
    assert inner == expected
    assert found[271] == ifd.Entry(2, b"Acm\0")


@given(st.binary(max_size=80), st.integers(1, 8), st.floats(0.1, 9))
def test_any_blob_may_move(tail: bytes, turn: int, scale: float) -> None:
    for head in (b"II*\0\x08\0\0\0", b"MM\0*\0\0\0\x08"):
        for part in (tail, b"\1\0\x69\x87\4\0\1\0\0\0\x0a\0\0\0" + tail):
            blob = head + part
            assert len(exif.moved(blob, Motion(6, 7, turn))) == len(blob)
            assert len(exif.moved(blob, Motion(6, 7, 1, 1, 1, scale, scale, 3, 2))) == len(blob)
