"""Writes JPEG in tiled TIFF (TIFF 6.0 §15, TIFF Technical Note 2), as libtiff does: what large scans are kept in today.

Neither OpenImageIO nor pillow writes JPEG into tiles, so the tiles come from libjpeg-turbo by way of pillow and the
directory from here. Reading them is OpenImageIO's work.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sgicodec.bench.codec import Pixels8
from sgicodec.image import Source
from sgicodec.metadata.ifd import Directory, Entry, dump

__all__ = ["TILE", "write_jpeg_tiff"]

TILE = 256
"""Pixels a side of a tile."""

_SHORT, _LONG, _RATIONAL, _UNDEFINED = 3, 4, 5, 7
_JPEG, _YCBCR = 7, 6
_JFIF_BYTES = 18
"""Of the segment that a TIFF does without."""


def write_jpeg_tiff(source: Source, path: Path, quality: int) -> None:
    """4:2:0, tiles of 256×256 pixels with one set of tables for all, row of tiles by row of tiles. 8-bit RGB only."""
    offsets, sizes = [], []
    with path.open("wb") as file:
        file.write(b"II*\0\0\0\0\0")
        for tile in _tiles(source):
            data = _jpeg(tile, quality, streamtype=2)
            data = data[:2] + data[2 + _JFIF_BYTES :] if data[2:4] == b"\xff\xe0" else data
            offsets.append(file.tell())
            sizes.append(len(data))
            file.write(data)
        file.write(b"\0" * (file.tell() % 2))
        at = file.tell()
        tables = _jpeg(np.zeros((TILE, TILE, 3), np.uint8), quality, streamtype=1)
        file.write(dump(_directory(source.width, source.height, offsets, sizes, tables), at))
        file.seek(4)
        file.write(struct.pack("<I", at))


def _tiles(source: Source) -> Iterator[Pixels8]:
    """Tiles [256, 256, 3] row by row; those at the edges go on with the picture's last pixels."""
    for y in range(0, source.height, TILE):
        rows = source.read(0, y, source.width, min(TILE, source.height - y)).pixels
        beyond = ((0, TILE - len(rows)), (0, -source.width % TILE), (0, 0))
        rows = np.pad(rows, beyond, mode="edge")
        for x in range(0, source.width, TILE):
            yield np.ascontiguousarray(rows[:, x : x + TILE])


def _jpeg(tile: Pixels8, quality: int, streamtype: int) -> bytes:
    """streamtype: 1 for tables alone, 2 for a picture without them."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(tile).save(buffer, "JPEG", quality=quality, subsampling="4:2:0", streamtype=streamtype)
    return buffer.getvalue()


def _directory(width: int, height: int, offsets: list[int], sizes: list[int], tables: bytes) -> Directory:
    numbers = {
        256: (_LONG, [width]),
        257: (_LONG, [height]),
        258: (_SHORT, [8, 8, 8]),
        259: (_SHORT, [_JPEG]),
        262: (_SHORT, [_YCBCR]),
        277: (_SHORT, [3]),
        284: (_SHORT, [1]),
        322: (_SHORT, [TILE]),
        323: (_SHORT, [TILE]),
        324: (_LONG, offsets),
        325: (_LONG, sizes),
        530: (_SHORT, [2, 2]),
        532: (_RATIONAL, [value for pair in (0, 255, 128, 255, 128, 255) for value in (pair, 1)]),
    }
    entries: Directory = {
        tag: Entry(kind, np.array(values, "<u2" if kind == _SHORT else "<u4").tobytes())
        for tag, (kind, values) in numbers.items()
    }
    entries[347] = Entry(_UNDEFINED, tables)
    return dict(sorted(entries.items()))
