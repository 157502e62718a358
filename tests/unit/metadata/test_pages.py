"""Pages among the directories of a TIFF file."""

from __future__ import annotations

import io
import struct
from pathlib import Path

import numpy as np
import tifffile

from sgicodec.metadata import ifd
from sgicodec.metadata.pages import PageBytes, tiff_pages


def three(**options: bool) -> bytes:
    file = io.BytesIO()
    with tifffile.TiffWriter(file, **options) as writer:
        for side in (3, 4, 5):
            writer.write(np.zeros((side, side + 1), np.uint8), metadata=None, photometric="minisblack")
    return file.getvalue()


def test_sizes_and_places() -> None:
    for data in (three(), three(bigtiff=True)):
        pages = tiff_pages(data)
        assert [(page.number, page.width, page.height) for page in pages] == [(0, 4, 3), (1, 5, 4), (2, 6, 5)]


def test_a_page_as_if_it_were_the_first(tmp_path: Path) -> None:
    for data in (three(), three(bigtiff=True)):
        (tmp_path / "x.tif").write_bytes(data)
        with (tmp_path / "x.tif").open("rb") as file:
            for page in tiff_pages(data):
                seen = PageBytes(file, page)
                width = ifd.load(seen)[256]
                assert isinstance(width, ifd.Entry)
                assert int.from_bytes(width.data, "little") == page.width
                assert seen[:2] == data[:2]
                assert seen[40:60] == data[40:60]
                assert seen[3] == data[3]


def test_a_chain_that_is_damaged_ends_there() -> None:
    data = bytearray(three())
    first, second, third = (page.offset for page in tiff_pages(bytes(data)))
    count = struct.unpack("<H", data[second : second + 2])[0]
    place = slice(second + 2 + 12 * count, second + 6 + 12 * count)
    for wrong in (first, second, len(data) + 9):
        data[place] = struct.pack("<I", wrong)
        assert [page.offset for page in tiff_pages(bytes(data))][:2] == [first, second]
    data[place] = struct.pack("<I", third)
    assert len(tiff_pages(bytes(data))) == 3
    assert tiff_pages(b"II*\0" + bytes(3)) == []
    assert tiff_pages(b"no TIFF") == []
