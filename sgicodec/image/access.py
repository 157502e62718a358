"""Windows of stored pixels: by tiles, by a band of rows, or out of the whole picture."""

from __future__ import annotations

import numpy as np

from sgicodec.arrays import Samples
from sgicodec.errors import PictureError
from sgicodec.image.opened import Opened
from sgicodec.metadata.orientation import is_flipped, is_sideways

_CHUNK_SAMPLES = 1 << 22
"""Samples that are asked of OpenImageIO at once, on top of the band that they go to. Its Python binding holds them
twice.
"""

MAX_KEPT = 1 << 27
"""Bytes of all samples of a picture whose rows are kept: an encode reads them five times, and to decode a PNG of 17
megapixels takes 0.7 s, a fortieth of its encode at effort 1."""

_ANY_ROW = ("tiff",)
"""Formats whose rows can be read from anywhere without decoding all those before."""


def access(opened: Opened, keeps: bool = False) -> Tiles | Rows:
    """The way with the least memory for this picture. keeps: rows of a picture of up to MAX_KEPT bytes stay in memory
    once they were read.

    So do those of a picture whose rows must be read in another order than they are decoded in.
    """
    spec = opened.spec
    if spec.tile_width:
        return Tiles(opened)
    backward = is_flipped(opened.orientation) and opened.kind not in _ANY_ROW
    is_small = spec.width * spec.height * spec.nchannels * opened.native.itemsize <= MAX_KEPT
    is_kept = backward or is_sideways(opened.orientation) or not opened.reads_parts or (keeps and is_small)
    return KeptRows(opened) if is_kept else Rows(opened)


class Tiles:
    """For files in tiles: reads those that a window touches, a row of tiles at a time."""

    def __init__(self, opened: Opened) -> None:
        self._opened = opened

    def read(self, x: int, y: int, width: int, height: int) -> Samples:
        """A window [height, width, C] in the native type, a copy. Raises PictureError."""
        spec = self._opened.spec
        left = x - x % spec.tile_width
        right = min(left - (left - x - width) // spec.tile_width * spec.tile_width, spec.width)
        window = _empty(self._opened, height, width)
        for top in range(y - y % spec.tile_height, y + height, spec.tile_height):
            bottom = min(top + spec.tile_height, spec.height)
            where = (spec.x + left, spec.x + right, spec.y + top, spec.y + bottom, 0, 1)
            tiles = self._opened.samples(self._opened.image.read_tiles, bottom - top, *where)
            start, stop = max(top, y), min(bottom, y + height)
            window[start - y : stop - y] = tiles[start - top : stop - top, x - left : x - left + width]
        return window

    def held(self, width: int, height: int) -> int:
        """Most samples that exist at once while such windows are read one after the other, the window included."""
        spec = self._opened.spec
        across = min(width + 2 * spec.tile_width, spec.width)
        return int((width * height + 2 * across * spec.tile_height) * spec.nchannels)


class Rows:
    """For files in rows: keeps the band of full rows that the last window came from, and reads on from there.

    Windows side by side cost nothing more. Rows above the band are decoded again, in most formats from the first on.
    """

    def __init__(self, opened: Opened) -> None:
        self._opened = opened
        # libtiff reads compressed planes in whole strips only. Where a picture's first row is not row 0, OpenImageIO
        # takes strips to begin at other rows than they do.
        in_strips = opened.spec.get("planarconfig") == "separate" or opened.spec.y != 0
        strip = opened.spec.get_int_attribute("tiff:RowsPerStrip", 1) if in_strips else 1
        self._step = min(strip, opened.spec.height) if opened.reads_parts else opened.spec.height
        self._row_samples = int(opened.spec.width * opened.spec.nchannels)
        self._first = 0
        self._band = self._empty(0)
        self._next = 0
        """The row that OpenImageIO stands at."""

    def _empty(self, rows: int) -> Samples:
        return _empty(self._opened, rows, self._opened.spec.width)

    def read(self, x: int, y: int, width: int, height: int) -> Samples:
        """As of `Tiles`."""
        start, stop = y - y % self._step, self._step_end(y + height)
        if not self._first <= start <= stop <= self._first + len(self._band):
            self._move(start, stop)
        return self._band[y - self._first : y - self._first + height, x : x + width].copy()

    def _step_end(self, row: int) -> int:
        """The row from `row` on up to which rows must be read."""
        return min(-(-row // self._step) * self._step, self._opened.spec.height)

    def whole(self) -> Samples:
        """All rows, which the caller owns."""
        pixels = self._empty(self._opened.spec.height)
        self._fill(pixels, 0)
        return pixels

    def _move(self, start: int, stop: int) -> None:
        """Make the band rows start … stop; rows that it holds already are kept."""
        begin = min(max(start, self._first), stop)
        end = max(min(stop, self._first + len(self._band)), begin)
        kept = self._band[begin - self._first : end - self._first].copy() if end > begin else self._band[:0]
        if len(self._band) != stop - start:
            del self._band  # before the new one takes memory
            self._band = self._empty(stop - start)
        self._first = start
        self._band[begin - start : end - start] = kept
        del kept
        try:
            self._fill(self._band[: begin - start], start)
            self._fill(self._band[end - start :], end)
        except BaseException:
            self._band = self._empty(0)
            raise

    def _fill(self, band: Samples, start: int) -> None:
        """Read rows from `start` on into `band`, some at a time."""
        if start < self._next and len(band):
            self._opened.reopen()  # faster than OpenImageIO's own way back
        rows = max(1, _CHUNK_SAMPLES // (self._row_samples * self._step)) * self._step
        for top in range(start, start + len(band), rows):
            bottom, offset = min(top + rows, start + len(band)), self._opened.spec.y
            reader = self._opened.image.read_scanlines
            self._next = self._opened.spec.height  # where a reader stands that fails, nobody knows
            part = self._opened.samples(reader, bottom - top, offset + top, offset + bottom, 0)
            band[top - start : bottom - start] = part
            self._next = bottom

    def held(self, width: int, height: int) -> int:
        """As of `Tiles`."""
        rows, channels = self._opened.spec.height, self._opened.spec.nchannels
        chunk = min(max(_CHUNK_SAMPLES, self._row_samples * self._step), self._row_samples * rows)
        return self._row_samples * self._held_rows(height) + int(max(2 * chunk, width * height * channels))

    def _held_rows(self, height: int) -> int:
        """Most rows that are kept while windows of this height are read."""
        return min(height + 2 * (self._step - 1), self._opened.spec.height)


class KeptRows(Rows):
    """The same where rows are read several times: keeps all from the first to the last that was read."""

    def __init__(self, opened: Opened) -> None:
        super().__init__(opened)
        self._pixels = self._empty(opened.spec.height)
        self._known = 0

    def read(self, x: int, y: int, width: int, height: int) -> Samples:
        """As of `Tiles`."""
        stop = self._step_end(y + height)
        if stop > self._known:
            self._fill(self._pixels[self._known : stop], self._known)
            self._known = stop
        return self._pixels[y : y + height, x : x + width].copy()

    def _held_rows(self, height: int) -> int:
        return self._opened.spec.height


def whole(opened: Opened) -> Samples:
    """All stored samples [H, W, C] in their native type. Raises PictureError.

    They are read part by part: OpenImageIO's own way takes their memory twice.
    """
    spec = opened.spec
    return Tiles(opened).read(0, 0, spec.width, spec.height) if spec.tile_width else Rows(opened).whole()


def _empty(opened: Opened, rows: int, columns: int) -> Samples:
    try:
        return np.empty((rows, columns, opened.spec.nchannels), opened.native)
    except MemoryError:
        raise PictureError("there is not enough memory for its pixels") from None
