"""Pages among the directories of a TIFF file."""

from __future__ import annotations

import io
import struct

import numpy as np
import tifffile

from sgicodec.metadata.pages import tiff_pages


def three(**options: bool) -> bytes:
    file = io.BytesIO()
    with tifffile.TiffWriter(file, **options) as writer:
        for side in (3, 4, 5):
            writer.write(np.zeros((side, side + 1), np.uint8), metadata=None, photometric="minisblack")
    return file.getvalue()


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
