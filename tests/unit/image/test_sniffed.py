"""HEIF, AVIF and raw files are named, with what reads them; no other picture is taken for one."""

from __future__ import annotations

import io
import struct
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile

from sgicodec import read, write
from sgicodec.errors import PictureError
from sgicodec.image.sniffed import others_below, sniffed_format
from sgicodec.metadata.filebytes import FileBytes
from sgicodec.picture import Picture

PICTURES = sorted((Path(__file__).parents[2] / "data").rglob("*.*"))


def directory(rows: list[tuple[int, int, int, int]], order: str) -> bytes:
    """A TIFF directory of rows (tag, type, count, value), without one that follows."""
    packed = b""
    for tag, kind, count, value in rows:
        field = struct.pack(order + "HH", value, 0) if kind == 3 else struct.pack(order + "I", value)
        packed += struct.pack(order + "HHI", tag, kind, count) + field
    return struct.pack(order + "H", len(rows)) + packed + bytes(4)


def tiff(order: str, photometric: int, below: tuple[int, ...] = (), extra: tuple[int, ...] = ()) -> bytes:
    """A TIFF of one black pixel, with directories of these photometric interpretations below the first."""
    rows = [(256, 4, 1, 1), (257, 4, 1, 1), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, photometric)]
    rows += [(273, 4, 1, 8), (277, 3, 1, 1), (278, 4, 1, 1), (279, 4, 1, 1)]
    rows += [(tag, 4, 1, 1) for tag in extra]
    subs = [directory([(262, 3, 1, value)], order) for value in below]
    start = 16 + len(directory([*rows, (330, 4, 1, 0)] if subs else rows, order))
    places = [start + sum(map(len, subs[:index])) for index in range(len(subs))]
    table = b"" if len(subs) < 2 else b"".join(struct.pack(order + "I", place) for place in places)
    if subs:
        at = places[0] if len(subs) == 1 else start + sum(map(len, subs))
        rows.append((330, 4, len(subs), at))
    head = (b"II*\0" if order == "<" else b"MM\0*") + struct.pack(order + "I", 16) + bytes(8)
    return head + directory(sorted(rows), order) + b"".join(subs) + table


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic", r"HEIF picture \(HEIC\).*heif-convert"),
        (b"\0\0\0\x18ftypcrx \0\0\0\x01crx isom", r"raw file \(CR3\).*darktable-cli"),
        (b"II*\0\x10\0\0\0CR\x02\0" + bytes(40), r"raw file \(CR2\)"),
        (b"FUJIFILMCCD-RAW 0201" + bytes(40), r"raw file \(RAF\)"),
        (b"IIRO\x08\0\0\0" + bytes(40), r"raw file \(ORF\)"),
        (tiff("<", 1, extra=(50706,)), r"raw file \(DNG\)"),
        (tiff(">", 32803), "raw file .of the TIFF family"),
        (tiff(">", 2, below=(32803,)), "raw file .of the TIFF family"),
        (tiff("<", 2, below=(6, 34892)), "raw file .of the TIFF family"),
    ],
)
def test_they_are_named_with_what_reads_them(
    content: bytes, complaint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for library in ("pillow_heif", "rawpy"):
        monkeypatch.setitem(sys.modules, library, None)
    (tmp_path / "a.dat").write_bytes(content)
    with pytest.raises(PictureError, match=complaint):
        read(tmp_path / "a.dat")


@pytest.mark.parametrize("content", [tiff("<", 1), tiff(">", 1, below=(2, 6)), tiff("<", 1, below=(1,))])
def test_other_files_of_the_family_are_read(content: bytes) -> None:
    assert sniffed_format(content) is None
    assert read(content).pixels.shape == (1, 1, 1)


@pytest.mark.parametrize("how", [{}, {"bigtiff": True, "byteorder": ">"}])
def test_a_preview_of_a_picture_below_it_is_refused(how: dict[str, Any]) -> None:
    """As of TIFF/EP; a reduction below is none."""
    pixels = np.zeros((300, 400), np.uint8)
    for first, below, expected in ((pixels[:30, :40], pixels, "400×300"), (pixels, pixels[:30, :40], None)):
        out = io.BytesIO()
        with tifffile.TiffWriter(out, **how) as file:
            file.write(first, subifds=1, subfiletype=1 if expected else 0, metadata=None)
            file.write(below, metadata=None)
        if expected:
            with pytest.raises(PictureError, match=f"a preview: a picture of {expected} pixels in a sub-directory"):
                read(out.getvalue())
        else:
            assert read(out.getvalue()).pixels.shape[:2] == (300, 400)


@pytest.mark.parametrize(("kind", "names"), [(0, ["1 picture in sub-directories"]), (1, [])])
def test_a_picture_below_that_is_no_reduction_is_named(kind: int, names: list[str]) -> None:
    out, pixels = io.BytesIO(), np.zeros((30, 40), np.uint8)
    with tifffile.TiffWriter(out) as file:
        file.write(pixels, subifds=1, metadata=None)
        file.write(pixels, subfiletype=kind, metadata=None)
    assert others_below(out.getvalue()) == names


def test_no_picture_is_taken_for_one(tmp_path: Path) -> None:
    assert len(PICTURES) > 20
    for path in PICTURES:
        if path.suffix != ".md":
            with path.open("rb") as file:
                assert sniffed_format(FileBytes(file)) is None, path
    picture = Picture(np.zeros((40, 40, 3), np.uint8), "rgb", (0.0, 255.0))
    for suffix in ("tif", "jxl", "jp2", "webp", "jpg", "png"):
        write(picture, tmp_path / f"a.{suffix}")
        assert sniffed_format((tmp_path / f"a.{suffix}").read_bytes()) is None


@pytest.mark.parametrize("cut", range(0, 200, 7))
def test_damage_is_no_crash(cut: int) -> None:
    content = tiff("<", 2, below=(6, 34892))
    sniffed_format(content[:cut])
