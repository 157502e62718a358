"""The decoder: from a stream to pixels, any region at any scale. Imports neither torch nor OpenImageIO."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping as Lookup
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.bitstream.stream_reader import StreamReader
from sgicodec.decoder.bands import Bands
from sgicodec.decoder.compositor import render_view, sample_mapping
from sgicodec.decoder.tile_cache import TileCache
from sgicodec.decoder.tile_renderer import TileRenderer, joined_crc
from sgicodec.decoder.view import MAX_OUTPUT_SAMPLES, Region, View, overview_size, overview_view, view_of
from sgicodec.device import ALL_CORES, Device
from sgicodec.errors import CorruptStreamError, StreamError, UsageError
from sgicodec.metadata.placement import view as geo_view
from sgicodec.picture import Metadata, Picture
from sgicodec.raster import Mapping

__all__ = ["MAX_OUTPUT_SAMPLES", "Bands", "Region", "Stream", "Survey", "open_stream"]

F32 = NDArray[np.float32]

_MOST_TEXT = 200
"""Bytes that are shown of the name of the program that wrote a stream."""


class Survey(NamedTuple):
    """What all tiles hold together: number of seeds, bytes of each part, checksum of all decoded symbols, and how many
    cells of texture there are, by their side in pixels.
    """

    seeds: int
    part_bytes: dict[str, float]
    symbol_crc: int
    texture_cells: dict[int, int]


class Stream:
    """An opened `.sgi` stream: header and metadata at once, pixels on demand. A context manager.

    Of several tiles those are read and decoded that a region touches. `size` is the stream's length in bytes,
    `chunk_bytes` that of every chunk by its letter, frame included. Views of a sixteenth and less show the overview of
    a stream that has one, unless `exact` asks for all that the stream holds.
    """

    exact: bool = False

    def __init__(self, source: bytes | BinaryIO, owned: BinaryIO | None = None, device: Device = ALL_CORES) -> None:
        self._owned = owned
        self._chunks = StreamReader(source)
        self.header, self.size, blobs = self._chunks.header, self._chunks.size, self._chunks.blobs
        self.chunk_bytes = self._chunks.chunk_bytes
        self.metadata = Metadata(icc=blobs.get("i"), exif=blobs.get("c"), xmp=blobs.get("x"), geo=blobs.get("g"))
        self.software = _printable(blobs.get("s", b""))
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
        if self._owned is not None:
            self._owned.close()

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

    def render(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: tuple[int, int] | None = None,
    ) -> F32:
        """Samples [h, w, C] of a region (x, y, width, height in the picture's pixels), nominally 0..1, not clipped.

        `scale` multiplies the region's size, `size` states it instead. Enlarging draws the continuous function between
        the old pixels; shrinking filters, so that nothing aliases. Raises UsageError or LimitError.
        """
        view = view_of(self.header, region, scale, size)
        samples = np.empty((view.rows, view.columns, self.header.spec.channels), np.float32)
        self._draw(view, samples, None)
        return samples

    def picture(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: tuple[int, int] | None = None,
    ) -> Picture:
        """The same as a picture in the source's depth and layout, with its metadata."""
        header = self.header
        view = view_of(self.header, region, scale, size)
        pixels = np.empty((view.rows, view.columns, header.spec.channels), header.sample_type)
        self._draw(view, pixels, sample_mapping(header))
        return Picture(pixels, header.channels, header.sample_range, self._placed(view))

    def bands(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: tuple[int, int] | None = None,
    ) -> Bands:
        """The same picture in bands of rows from the top down, for what need not fit into memory."""
        view = view_of(self.header, region, scale, size, most=None)
        mapping = sample_mapping(self.header)
        return Bands(self.header, view, self._placed(view), lambda out, top: self._draw(view, out, mapping, top))

    def _placed(self, view: View) -> Metadata:
        return replace(self.metadata, geo=geo_view(self.metadata.geo, view.x, view.y, view.sx, view.sy))

    def _draw(self, view: View, out: NDArray[Any], mapping: Mapping | None, top: int = 0) -> None:
        """Fills out [rows, columns, C] with samples of the view from its row `top` on."""
        small = overview_view(self.header, view) if self.has_overview and not self.exact else None
        if small is None:
            render_view(self.header, self._tiles, view, out, mapping, self.device, top)
        else:
            self.overview._draw(small, out, mapping, top)

    @property
    def has_overview(self) -> bool:
        """Whether the stream carries the picture in small."""
        return self._chunks.has_overview

    @property
    def overview(self) -> Stream:
        """The stream that shows the picture in small. Raises StreamError, UsageError where there is none."""
        if self._overview is None:
            payload = self._chunks.overview()
            if payload is None:
                raise UsageError("there is no overview")
            try:
                self._overview = _checked_overview(Stream(payload, device=self.device), self.header)
            except StreamError as error:
                raise type(error)(f"overview: {error}") from error.__cause__
        return self._overview

    def payload(self, number: int) -> bytes:
        """What the chunk of a tile holds. Raises CorruptStreamError."""
        return self._chunks.tile(number)

    def tile(self, number: int) -> TileRenderer:
        """A decoded tile. Raises CorruptStreamError or LimitError."""
        return self._tiles.tile(number)


def open_stream(source: str | Path | bytes | BinaryIO, device: Device = ALL_CORES) -> Stream:
    """Opens a stream from a path, bytes or a binary file object. Raises StreamError for what is none.

    device: what decodes it; ValueError later for an instruction set that this machine lacks.
    """
    if isinstance(source, bytes) or not isinstance(source, str | Path):
        return Stream(source, device=device)
    file = Path(source).open("rb")  # noqa: SIM115 (the stream closes it)
    try:
        return Stream(file, file, device)
    except BaseException:
        file.close()
        raise


def _checked_overview(stream: Stream, header: Header) -> Stream:
    """The overview, if it has the size and the samples that the picture's has to have."""
    found, size = stream.header, overview_size(header.width, header.height)
    if (found.width, found.height) != size:
        raise CorruptStreamError(f"it has {found.width}×{found.height} pixels, not {size[0]}×{size[1]}")
    if (found.channels, found.spec.channels) != (header.channels, header.spec.channels):
        raise CorruptStreamError("its channels are not the picture's")
    if (found.sample_type, found.sample_range) != (header.sample_type, header.sample_range):
        raise CorruptStreamError("its samples are not of the picture's type and range")
    return stream


def _printable(text: bytes) -> str:
    """The start of a text that somebody else wrote, without what could steer a terminal."""
    decoded = text[:_MOST_TEXT].decode("utf-8", "replace")
    return "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in decoded)
