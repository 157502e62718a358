"""Writing PNG without OpenImageIO, which loads slowly and compresses on one thread (PNG 3; RFC 1950 and 1951).

Rows are deflated in strips of fixed size, each with the end of the one before as its dictionary and to a whole byte.
One after the other they are one zlib stream, whose bytes depend neither on how the rows came nor on the threads.
"""

from __future__ import annotations

import contextlib
import struct
import zlib
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from isal import isal_zlib

from sgicodec import _native
from sgicodec.image.header import Probe
from sgicodec.metadata.png import SIGNATURE, chunk, metadata_chunks
from sgicodec.picture import Metadata

DEFAULT_LEVEL = 2
"""Effort of deflate, 0 to 9. More takes a few percent off photographs in several times the time
(docs/performance.md, "Decode")."""
_FAST_LEVELS = (1, 2)
"""Those of ISA-L; the others are zlib's (docs/notes/2026-11-decode.md)."""

_STRIP_BYTES = 1 << 19
_WINDOW = 1 << 15
"""How far back deflate can refer."""

_ZLIB_HEADER = b"\x78\x01"
_COLOUR_TYPES = {"gray": 0, "rgb": 2, "gray+alpha": 4, "rgba": 6}


class PngOutput:
    """The PNG file at `path` of a picture with this header. Rows come in order.

    level: effort of deflate, 0 to 9; `DEFAULT_LEVEL` if None. threads: 0 for all cores. Takes memory for the rows that
    it is given and for a strip per thread.
    """

    def __init__(
        self, path: Path, header: Probe, metadata: Metadata, level: int | None = None, threads: int = 0
    ) -> None:
        self._header, self._threads = header, _native.resolve_threads(threads)
        self._level = DEFAULT_LEVEL if level is None else level
        self._pixel_bytes = header.count * header.dtype.itemsize
        self._row_bytes = header.width * self._pixel_bytes
        self._strip_rows = max(1, _STRIP_BYTES // self._row_bytes)
        self._next = 0
        self._strip = np.empty((self._strip_rows, self._row_bytes), np.uint8)
        self._above = np.zeros(self._row_bytes, np.uint8)
        self._window, self._adler = b"", 1
        self._pool = ThreadPoolExecutor(self._threads)
        self._working: deque[Future[bytes]] = deque()
        self._begun = False
        self._file = path.open("wb")
        depth, colour = 8 * header.dtype.itemsize, _COLOUR_TYPES[header.channels]
        self._file.write(SIGNATURE)
        self._file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", header.width, header.height, depth, colour, 0, 0, 0)))
        self._file.write(metadata_chunks(metadata))

    @property
    def row(self) -> int:
        """The row that comes next."""
        return self._next

    def write(self, pixels: npt.NDArray[Any]) -> None:
        """Take the next rows [n, W, C]. Raises OSError."""
        while len(pixels):
            filled = self._next % self._strip_rows
            taken = min(self._strip_rows - filled, len(pixels))
            self._strip[filled : filled + taken] = self._bytes_of(pixels[:taken])
            self._next += taken
            pixels = pixels[taken:]
            if filled + taken == self._strip_rows or self._next == self._header.height:
                self._deflate(self._strip[: filled + taken])

    def _bytes_of(self, pixels: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
        """Samples as PNG orders them [n, bytes of a row]."""
        ordered = np.ascontiguousarray(pixels, pixels.dtype.newbyteorder(">"))
        return ordered.view(np.uint8).reshape(len(pixels), self._row_bytes)

    def _deflate(self, rows: npt.NDArray[np.uint8]) -> None:
        """Filter rows and have them deflated while the next ones come."""
        filtered = np.empty((len(rows), 1 + self._row_bytes), np.uint8)
        _native.png_filter(rows, self._above, self._pixel_bytes, filtered)
        self._above = rows[-1].copy()
        data = filtered.tobytes()
        self._adler = isal_zlib.adler32(data, self._adler)
        is_last = self._next == self._header.height
        self._working.append(self._pool.submit(_deflated, data, self._window, self._level, is_last))
        self._window = data[-_WINDOW:]
        while len(self._working) >= self._threads:
            self._write_next()

    def _write_next(self) -> None:
        data = self._working.popleft().result()
        if not self._begun:
            data = _ZLIB_HEADER + data
        self._begun = True
        if self._next == self._header.height and not self._working:
            data += struct.pack(">I", self._adler)
        self._file.write(chunk(b"IDAT", data))

    def close(self) -> None:
        """Finish the file. Raises OSError."""
        while self._working:
            self._write_next()
        self._file.write(chunk(b"IEND", b""))
        self._file.close()
        self.abandon()

    def abandon(self) -> None:
        """Let go of the file, finished or not."""
        self._pool.shutdown()
        with contextlib.suppress(OSError):  # of what a full disk did not take before
            self._file.close()


def _deflated(data: bytes, window: bytes, level: int, last: bool) -> bytes:
    """A strip deflated behind `window`, what came before it; ISA-L and zlib let other threads run."""
    library = isal_zlib if level in _FAST_LEVELS else zlib
    raw, memory = -zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL
    coder = library.compressobj(level, zlib.DEFLATED, raw, memory, zlib.Z_DEFAULT_STRATEGY, window)
    return b"".join((coder.compress(data), coder.flush(zlib.Z_FINISH if last else zlib.Z_SYNC_FLUSH)))
