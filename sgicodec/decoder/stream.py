"""An opened stream: any region at any scale. What decodes is native code; here are arguments, arrays and metadata."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from io import BufferedReader
from numbers import Integral
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, BinaryIO

from sgicodec import _native
from sgicodec.bitstream.chunks import metadata_of
from sgicodec.bitstream.header import Header, decode_header
from sgicodec.decoder.array_view import ArrayView
from sgicodec.decoder.bands import Bands
from sgicodec.decoder.survey import Survey, survey_of
from sgicodec.decoder.view import MAX_OUTPUT_SAMPLES, Region, Size, View, view_of
from sgicodec.decoder.view_metadata import view_metadata
from sgicodec.device import ALL_CORES, Device, check_device
from sgicodec.errors import RegionError, StreamError, UsageError
from sgicodec.remote.url import is_url

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import DTypeLike, NDArray

    from sgicodec.bitstream.parts.tile import TileModel
    from sgicodec.picture import Picture

    F32 = NDArray[np.float32]

__all__ = ["MAX_OUTPUT_SAMPLES", "Bands", "BytesLike", "Region", "Size", "Stream", "file_at", "open_stream"]

CACHE_BYTES = 1 << 28
"""What decoded tiles may take before those that were used least recently are released."""
BLOCK_SAMPLES = 1 << 27
"""A picture is rendered in blocks of at most so many samples; a sixteenth with texture, which is rendered to floats."""
_MAX_SOFTWARE = 200
"""Bytes that are shown of the name of the program that wrote a stream."""

BytesLike = bytes | bytearray | memoryview | Any
"""Whatever has a buffer: also mmap, and arrays of bytes."""


class Stream(ArrayView):
    """An opened `.sgi` stream: header and metadata at once, pixels on demand. A context manager.

    Of several tiles those are read and decoded that a region touches. `size` is the stream's length in bytes,
    `chunk_bytes` that of every chunk by its letter, frame included. Views of a sixteenth and less show the overview of
    a stream that has one, unless `exact` asks for all that the stream holds. Samples
    of 8 bits are dithered where the source had more, unless `dither` is False. A residual layer brings views in the
    picture's own pixels and type to the source, but for `max_error` levels, unless `lossy` leaves it aside. `name` is
    its path, if it was opened by one. Several threads may use one at once; they take turns.
    """

    exact: bool = False
    dither: bool = True
    lossy: bool = False

    def __init__(
        self,
        source: bytes | BinaryIO,
        path: str | None = None,
        device: Device = ALL_CORES,
        native: _native.Stream | None = None,
    ) -> None:
        """native: what decodes it, if it is there already."""
        self.name, self.device = path, device
        self._source: bytes | BinaryIO | None = source
        self._native: _native.Stream | None = native or _opened(source, device)
        blobs = self._native.blobs
        self.header = decode_header(blobs["H"])
        self.size, self.chunk_bytes = self._native.size, self._native.chunk_bytes
        self.has_overview = self._native.has_overview
        """Whether the stream carries the picture in small."""
        self.metadata = metadata_of(blobs)
        self.software = _printable(blobs.get("s", b""))
        self.grid = self.header.grid
        if self.nodata is not None:
            self._native.set_blank(self.nodata)
        self._overview: Stream | None = None

    def __enter__(self) -> Stream:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self._native is None

    def close(self) -> None:
        """Closes a file that was opened by its path, and forgets what was decoded. What follows raises UsageError."""
        self._native = self._overview = None
        if self.name is not None and self._source is not None and not isinstance(self._source, bytes):
            self._source.close()

    def __repr__(self) -> str:
        header = self.header
        what = f"{header.width}×{header.height} {header.channels} {header.sample_type}, {self.size:,} bytes"
        name = "" if self.name is None else f" {self.name!r}"
        return f"<sgicodec.Stream{name} {what}{', closed' * self.closed}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by its path, or with its bytes: what reads it opens the stream again."""
        if self.name is None and not isinstance(self._source, bytes):
            raise UsageError("a stream that reads a file object cannot be pickled; open it by its path")
        source = self._source if self.name is None else self.name if is_url(self.name) else os.path.abspath(self.name)
        return (
            open_stream,
            (source, self.device),
            {
                "exact": self.exact,
                "dither": self.dither,
                "lossy": self.lossy,
            },
        )

    @property
    def nodata(self) -> float | None:
        """The sample value that stands for "nothing was measured here", or None."""
        if self.header.masked == "nodata":
            return self.header.nodata
        if self.metadata.geo is None:
            return None
        from sgicodec.metadata.geo import nodata

        return nodata(self.metadata.geo, self.dtype)

    @property
    def width(self) -> int:
        """Columns of the picture."""
        return self.header.width

    @property
    def height(self) -> int:
        """Rows of the picture."""
        return self.header.height

    @property
    def model(self) -> TileModel:
        """The decoded model of a picture in one tile. Raises CorruptStreamError or LimitError."""
        if self.grid.count > 1:
            raise UsageError(f"there are {self.grid.count} models, one in each tile")
        model = self.tile_model(0)
        if model is None:
            raise UsageError("there is no model: no pixel holds anything")
        return model

    def tile_model(self, number: int) -> TileModel | None:
        """The model of a tile, None where no pixel holds anything. Raises StreamError, RegionError."""
        from sgicodec.bitstream.parts.tile import read_tile
        from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk

        payload = decode_tile_chunk(self.header, self.payload(number)).model
        return None if payload is None else read_tile(self.header.of_tile(number), payload, self.device)[0]

    @property
    def max_error(self) -> float | None:
        """Levels by which no sample is off the source's at most: 0 without loss; None without residual layer, and with
        one that shows some bands, or text and line art, alone.
        """
        found = self._open_native().max_error
        return None if found < 0 else found

    @property
    def graphics_error(self) -> float | None:
        """Levels by which no sample of text and line art is off, where a residual layer shows these alone; or None."""
        found = self._open_native().graphics_error
        return None if found < 0 else found

    @property
    def exact_bands(self) -> tuple[int, ...]:
        """Bands, from 1 on, whose samples a residual layer shows, where it shows these alone, in the picture's own
        pixels and type.
        """
        return tuple(band + 1 for band in self._open_native().exact_bands)

    @property
    def has_exact_pixels(self) -> bool:
        """Whether a residual layer shows samples of all or some bands in the picture's own pixels and type."""
        return self.max_error is not None or bool(self.exact_bands)

    @property
    def has_exact_alpha(self) -> bool:
        """Whether a residual layer shows alpha, and nothing else, of every view."""
        return bool(self._open_native().has_exact_alpha)

    @property
    def has_exact_views(self) -> bool:
        """Whether the residual layer alone shows all views, or the text and line art in them, or their alpha."""
        return bool(self._open_native().has_exact_views)

    @property
    def symbol_crc(self) -> int:
        """CRC-32 of every decoded symbol of the tiles: equal on every machine."""
        return self.survey().symbol_crc

    @property
    def part_bytes(self) -> Mapping[str, float]:
        """Bytes of each part of the tiles, by information content."""
        return self.survey().part_bytes

    def survey(self) -> Survey:
        """Decodes all tiles. Raises CorruptStreamError or LimitError."""
        return survey_of(self._open_native(), self.header.masked is not None)

    def check_residual(self) -> None:
        """Checks the CRC of a residual layer's chunk, if any, which no view does. Raises CorruptStreamError."""
        self._open_native().check_residual()

    def render(self, region: Region | None = None, scale: float | None = None, size: Size | None = None) -> F32:
        """Samples [h, w, C] of a region (x, y, width, height in the picture's pixels), nominally 0..1, not clipped.

        `scale` multiplies the region's size, `size` states it instead: (width, height), where one may be None.
        Enlarging draws the continuous function between the old pixels; shrinking filters, so that nothing aliases.
        Raises UsageError, RegionError for a region that is not inside the picture, or LimitError.
        """
        view = view_of(self.header, region, scale, size)
        self._open_native().prepare(view, self.exact)
        return self._draw(view, "float32", 0, view.rows, mapped=False)

    def picture(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: Size | None = None,
        dtype: DTypeLike | None = None,
        boundless: bool = False,
    ) -> Picture:
        """A region of the picture as a `Picture` in the source's layout, pixels [h, w, C], with its metadata.

        region: (x, y, width, height) in the picture's pixels, by default all. scale multiplies its size, size states it
        instead: (width, height), where one may be None. dtype: of the samples, rendered as such: uint8, uint16 or
        float32, by default the source's; in another type the range of samples is the whole type's. boundless: a region
        may reach over the picture; what lies outside is nodata, else 0.

        Raises UsageError, RegionError for a region that is not inside the picture, LimitError for more than 2³¹ samples
        or memory, CorruptStreamError.
        """
        view = view_of(self.header, region, scale, size, boundless=boundless)
        header = self._header(dtype)
        self._open_native().prepare(view, self.exact)
        pixels = self._draw(view, header.sample_type, 0, view.rows)
        from sgicodec.picture import Picture  # loads numpy, and another thread may do so while it is rendered

        metadata = view_metadata(self.metadata, self.header.sample_type, header, view)
        return Picture(pixels, header.channels, header.sample_range, metadata, header.blank)

    def bands(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: Size | None = None,
        dtype: DTypeLike | None = None,
        boundless: bool = False,
    ) -> Bands:
        """The picture of `picture` in bands of rows from the top down, for what need not fit into memory.

        Parameters and errors are those of `picture`, without the limit of samples. Iterate it for pairs of the first
        row and a `Picture` of the rows from there on; `width`, `height` and `metadata` are those of the whole.
        """
        view = view_of(self.header, region, scale, size, most=None, boundless=boundless)
        header = self._header(dtype)
        metadata = view_metadata(self.metadata, self.header.sample_type, header, view)
        return Bands(header, view, metadata, partial(self._draw, view, header.sample_type))

    def _open_native(self) -> _native.Stream:
        native = self._native
        if native is None:
            raise UsageError("the stream is closed")
        return native

    def _header(self, dtype: DTypeLike | None) -> Header:
        """The header of a picture in another type of samples."""
        if dtype is None:
            return self.header
        from sgicodec.decoder.samples import converted  # loads numpy

        return converted(self.header, self.nodata, dtype)

    def _draw(self, view: View, sample_type: str, top: int, rows: int, mapped: bool = True) -> NDArray[Any]:
        """Samples [rows, columns, C] of the view from its row `top` on. Values as they are where they are not
        `mapped`.
        """
        return self._open_native().draw(view, top, rows, sample_type, mapped, self.exact, self.dither, self.lossy)

    @property
    def overview(self) -> Stream:
        """The stream that shows the picture in small. Raises StreamError, UsageError where there is none."""
        native = self._open_native()
        if self._overview is None:
            small = native.overview
            self._overview = Stream(native.overview_bytes, device=self.device, native=small)
        return self._overview

    def payload(self, number: int) -> bytes:
        """What the chunk of a tile holds. Raises CorruptStreamError, RegionError for a number that no tile has."""
        native = self._open_native()
        if not isinstance(number, Integral):
            raise UsageError(f"tile {number!r}; tiles have numbers")
        if not 0 <= number < self.grid.count:
            raise RegionError(f"tile {number}; there are tiles 0 to {self.grid.count - 1}")
        return native.tile(int(number))


def open_stream(source: str | os.PathLike[str] | BytesLike | BinaryIO, device: Device = ALL_CORES) -> Stream:
    """Opens a stream from a path, a URL, bytes of any kind or a binary file object. Raises StreamError if it is none.

    device: what decodes it; ValueError for an instruction set that this machine lacks.
    """
    check_device(device)
    if isinstance(source, str | os.PathLike):
        return _open_file(os.fspath(source), device)
    with suppress(TypeError):
        source = bytes(memoryview(source))  # type: ignore[arg-type]
    if not isinstance(source, bytes) and not hasattr(source, "read"):
        raise UsageError(f"{type(source).__name__} is no stream; give a path, bytes or a binary file object")
    return Stream(source, device=device)  # type: ignore[arg-type]


def _printable(text: bytes) -> str:
    """The start of a text that somebody else wrote, without what could steer a terminal."""
    decoded = text[:_MAX_SOFTWARE].decode("utf-8", "replace")
    return "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in decoded)


def _opened(source: bytes | BinaryIO | int, device: Device) -> _native.Stream:
    return _native.Stream(source, device.threads, device.isa, CACHE_BYTES, BLOCK_SAMPLES)


def file_at(path: str) -> BinaryIO:
    """The file at a path or behind a URL. Raises OSError, or StreamError of a URL."""
    if not is_url(path):
        return Path(path).open("rb")
    from sgicodec.remote.remote_file import open_url  # takes long to load

    return open_url(path)


def _open_file(path: str, device: Device) -> Stream:
    try:
        file = file_at(path)
    except (OSError, ValueError) as error:
        text = getattr(error, "strerror", None) or error
        raise StreamError(f"{os.fsencode(path).decode('utf-8', 'replace')}: {text}") from error
    try:
        native = None
        if os.name == "posix" and isinstance(file, BufferedReader) and file.seekable():
            native = _opened(file.fileno(), device)  # which reads by itself, without Python
        return Stream(file, path, device, native)
    except BaseException:
        file.close()
        raise
