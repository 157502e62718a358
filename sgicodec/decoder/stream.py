"""The decoder: from a stream to pixels, any region at any scale. Imports neither torch nor OpenImageIO."""

from __future__ import annotations

import os
import threading
from collections import Counter
from collections.abc import Mapping as Lookup
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.bitstream.stream_reader import StreamReader
from sgicodec.bitstream.stream_summary import printable
from sgicodec.decoder.array_view import ArrayView
from sgicodec.decoder.bands import Bands
from sgicodec.decoder.compositor import render_view, sample_mapping
from sgicodec.decoder.samples import blank, converted, placed
from sgicodec.decoder.tile_cache import TileCache
from sgicodec.decoder.tile_renderer import TileRenderer, joined_crc
from sgicodec.decoder.view import (
    MAX_OUTPUT_SAMPLES,
    Region,
    Size,
    View,
    inner_view,
    overview_size,
    overview_view,
    view_of,
)
from sgicodec.device import ALL_CORES, Device, check_device
from sgicodec.errors import CorruptStreamError, StreamError, UsageError
from sgicodec.metadata.geo import nodata as nodata_of
from sgicodec.picture import Metadata, Picture
from sgicodec.remote.url import is_url, open_url

__all__ = ["MAX_OUTPUT_SAMPLES", "Bands", "BytesLike", "Region", "Size", "Stream", "Survey", "open_stream"]

F32 = NDArray[np.float32]


class Survey(NamedTuple):
    """What all tiles hold together: number of seeds, bytes of each part, checksum of all decoded symbols, and how many
    cells of texture there are, by their side in pixels.
    """

    seeds: int
    part_bytes: dict[str, float]
    symbol_crc: int
    texture_cells: dict[int, int]


BytesLike = bytes | bytearray | memoryview | Any
"""Whatever has a buffer: also mmap, and arrays of bytes."""


class Stream(ArrayView):
    """An opened `.sgi` stream: header and metadata at once, pixels on demand. A context manager.

    Of several tiles those are read and decoded that a region touches. `size` is the stream's length in bytes,
    `chunk_bytes` that of every chunk by its letter, frame included. Views of a sixteenth and less show the overview of
    a stream that has one, unless `exact` asks for all that the stream holds. Samples
    of 8 bits are dithered where the source had more, unless `dither` is False. `name` is its path, if it was opened by
    one. Several threads may use one at once; they take turns.
    """

    exact: bool = False
    dither: bool = True

    def __init__(
        self,
        source: bytes | BinaryIO,
        path: str | None = None,
        device: Device = ALL_CORES,
        is_overview: bool = False,
    ) -> None:
        self.name, self._source = path, source
        self._lock = threading.RLock()
        self.closed = False
        self._chunks = StreamReader(source, is_overview)
        self.header, self.size, blobs = self._chunks.header, self._chunks.size, self._chunks.blobs
        self.chunk_bytes = self._chunks.chunk_bytes
        self.metadata = Metadata(icc=blobs.get("i"), exif=blobs.get("c"), xmp=blobs.get("x"), geo=blobs.get("g"))
        self.software = printable(blobs.get("s", b""))
        self.grid = self.header.grid
        self.device = device
        self._tiles = TileCache(self._chunks, device)
        self._overview: Stream | None = None
        self._survey: Survey | None = None

    def __enter__(self) -> Stream:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes a file that was opened by its path, and forgets what was decoded. What follows raises UsageError."""
        with self._lock:
            if self.name is not None and not isinstance(self._source, bytes):
                self._source.close()
            self.closed = True
            self._tiles, self._overview = TileCache(self._chunks, self.device), None

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
        return open_stream, (source, self.device), {"exact": self.exact, "dither": self.dither}

    @property
    def nodata(self) -> float | None:
        """The sample value that stands for "nothing was measured here", or None."""
        header = self.header
        return header.nodata if header.masked == "nodata" else nodata_of(self.metadata.geo, self.dtype)

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
        model = self.tile(0).model
        if model is None:
            raise UsageError("there is no model: no pixel holds anything")
        return model

    @property
    def symbol_crc(self) -> int:
        """CRC-32 of every decoded symbol of the tiles: equal on every machine."""
        return self.survey().symbol_crc

    @property
    def part_bytes(self) -> Lookup[str, float]:
        """Bytes of each part of the tiles, by information content."""
        return self.survey().part_bytes

    def survey(self) -> Survey:
        """Decodes all tiles, one at a time. Raises CorruptStreamError or LimitError."""
        with self._lock:
            return self._surveyed()

    def _surveyed(self) -> Survey:
        self._check_open()
        if self._survey is None:
            parts: Counter[str] = Counter()
            cells: Counter[int] = Counter()
            crcs, seeds = [], 0
            for number in range(self.grid.count):
                take = self._tiles.tile if self.grid.count == 1 else self._tiles.decoded
                tile = take(number)
                parts.update({name: bits / 8 for name, bits in tile.bits.items()})
                if self.header.masked is not None:
                    parts["mask"] += tile.mask_bytes
                crcs.append(tile.symbol_crc)
                if tile.model is not None:
                    seeds += len(tile.model.layout)
                    cells.update({} if tile.model.texture is None else tile.model.texture.counts)
            self._survey = Survey(seeds, dict(parts), joined_crc(crcs), dict(cells))
        return self._survey

    def render(self, region: Region | None = None, scale: float | None = None, size: Size | None = None) -> F32:
        """Samples [h, w, C] of a region (x, y, width, height in the picture's pixels), nominally 0..1, not clipped.

        `scale` multiplies the region's size, `size` states it instead: (width, height), where one may be None.
        Enlarging draws the continuous function between the old pixels; shrinking filters, so that nothing aliases.
        Raises UsageError, RegionError for a region that is not inside the picture, or LimitError.
        """
        view = view_of(self.header, region, scale, size)
        self._prepare(view)
        samples = np.empty((view.rows, view.columns, self.header.spec.channels), np.float32)
        self._draw(view, samples, None)
        return samples

    def picture(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: Size | None = None,
        dtype: DTypeLike | None = None,
        boundless: bool = False,
    ) -> Picture:
        """The same as a picture in the source's layout, with its metadata.

        dtype: of its samples, rendered as such: uint8, uint16 or float32, by default the source's; in another type the
        range of samples is the whole type's. boundless: a region may reach over the picture; what lies outside is
        nodata, else 0.
        """
        view = view_of(self.header, region, scale, size, boundless=boundless)
        header = self._header(dtype)
        self._prepare(view)
        pixels = np.empty((view.rows, view.columns, header.spec.channels), header.sample_type)
        self._draw(view, pixels, header.sample_type)
        return Picture(pixels, header.channels, header.sample_range, placed(self, header, view))

    def bands(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: Size | None = None,
        dtype: DTypeLike | None = None,
        boundless: bool = False,
    ) -> Bands:
        """The same picture in bands of rows from the top down, for what need not fit into memory."""
        view = view_of(self.header, region, scale, size, most=None, boundless=boundless)
        header = self._header(dtype)
        draw = partial(self._draw, view)
        return Bands(header, view, placed(self, header, view), lambda out, top: draw(out, header.sample_type, top))

    def _check_open(self) -> None:
        if self.closed:
            raise UsageError("the stream is closed")

    def _header(self, dtype: DTypeLike | None) -> Header:
        """The header of a picture in another type of samples."""
        return self.header if dtype is None else converted(self.header, self.nodata, dtype)

    def _prepare(self, view: View) -> None:
        """Decodes a picture in one tile before memory is taken for its samples: a tile that is not sound costs none."""
        with self._lock:
            self._check_open()
            if self.grid.count == 1:
                self._tiles.tile(0)

    def _draw(self, view: View, out: NDArray[Any], dtype: str | None, top: int = 0) -> None:
        """Fills out [rows, columns, C] with samples of the view from its row `top` on, floats as they are for None."""
        inner, left, first = inner_view(view, self.width, self.height)
        with self._lock:
            self._check_open()
            if inner == view:
                self._draw_inside(view, out, dtype, top)
                return
            out[...] = blank(self, self._header(dtype))
            start, stop = max(top, first), min(top + len(out), first + inner.rows)
            if start < stop and inner.columns:
                part = out[start - top : stop - top, left : left + inner.columns]
                self._draw_inside(inner, part, dtype, start - first)

    def _draw_inside(self, view: View, out: NDArray[Any], dtype: str | None, top: int) -> None:
        small = overview_view(self.header, view) if self.has_overview and not self.exact else None
        if small is not None:
            self.overview.dither = self.dither
            self.overview._draw_inside(small, out, dtype, top)
            return
        header = self._header(dtype)
        mapping = None if dtype is None else sample_mapping(header)
        dither = self.dither and dtype == "uint8" != self.header.sample_type
        render_view(header, self._tiles, view, out, mapping, self.device, top, dither)

    @property
    def has_overview(self) -> bool:
        """Whether the stream carries the picture in small."""
        return self._chunks.has_overview

    @property
    def overview(self) -> Stream:
        """The stream that shows the picture in small. Raises StreamError, UsageError where there is none."""
        with self._lock:
            self._check_open()
            if self._overview is None:
                payload = self._chunks.overview()
                if payload is None:
                    raise UsageError("there is no overview")
                try:
                    small = Stream(payload, device=self.device, is_overview=True)
                    self._overview = _checked_overview(small, self.header)
                except StreamError as error:
                    raise type(error)(f"overview: {error}") from error.__cause__
            return self._overview

    def payload(self, number: int) -> bytes:
        """What the chunk of a tile holds. Raises CorruptStreamError."""
        with self._lock:
            self._check_open()
            return self._chunks.tile(number)

    def tile(self, number: int) -> TileRenderer:
        """A decoded tile. Raises CorruptStreamError or LimitError."""
        with self._lock:
            self._check_open()
            return self._tiles.tile(number)


def open_stream(source: str | os.PathLike[str] | BytesLike | BinaryIO, device: Device = ALL_CORES) -> Stream:
    """Opens a stream from a path, a URL, bytes of any kind or a binary file object. Raises StreamError if it is none.

    device: what decodes it; ValueError later for an instruction set that this machine lacks.
    """
    check_device(device)
    if isinstance(source, str | os.PathLike):
        return _open_file(os.fspath(source), device)
    with suppress(TypeError):
        source = bytes(memoryview(source))  # type: ignore[arg-type]
    if not isinstance(source, bytes) and not hasattr(source, "read"):
        raise UsageError(f"{type(source).__name__} is no stream; give a path, bytes or a binary file object")
    return Stream(source, device=device)  # type: ignore[arg-type]


def _open_file(path: str, device: Device) -> Stream:
    try:
        file = open_url(path) if is_url(path) else Path(path).open("rb")  # noqa: SIM115 (the stream closes it)
    except (OSError, ValueError) as error:
        text = getattr(error, "strerror", None) or error
        raise StreamError(f"{os.fsencode(path).decode('utf-8', 'replace')}: {text}") from error
    try:
        return Stream(file, path, device)
    except BaseException:
        file.close()
        raise


def _checked_overview(stream: Stream, header: Header) -> Stream:
    """The overview, if it has the size and the samples that the picture's has to have."""
    found, size = stream.header, overview_size(header.width, header.height)
    if size == (header.width, header.height):
        raise CorruptStreamError("it is no smaller than the picture")
    if (found.width, found.height) != size:
        raise CorruptStreamError(f"it has {found.width}×{found.height} pixels, not {size[0]}×{size[1]}")
    if (found.channels, found.spec.channels) != (header.channels, header.spec.channels):
        raise CorruptStreamError("its channels are not the picture's")
    if (found.sample_type, found.sample_range) != (header.sample_type, header.sample_range):
        raise CorruptStreamError("its samples are not of the picture's type and range")
    return stream
