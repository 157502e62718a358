"""From a stream to pixels: any region at any scale. Imports neither torch nor OpenImageIO."""

from __future__ import annotations

import math
from collections import Counter, OrderedDict
from collections.abc import Iterator
from collections.abc import Mapping as Lookup
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.tile import TileModel
from sgicodec.drawn_tile import DrawnTile, View, joined_crc
from sgicodec.errors import LimitError, StreamError, UsageError
from sgicodec.image import Metadata, Picture, full_range, geo_view
from sgicodec.image.picture import alpha_index
from sgicodec.masking import clear
from sgicodec.opened import OpenedChunks
from sgicodec.raster import Mapping
from sgicodec.tiles import Segment

__all__ = ["MAX_OUTPUT_SAMPLES", "Region", "Stream", "Survey", "open_stream"]

F32 = NDArray[np.float32]
Region = tuple[int, int, int, int]

MAX_OUTPUT_SAMPLES = 1 << 31
"""Most samples (pixels times channels) that one call renders."""

BASE_ALONE = 1.5
"""Output pixels per cell of the base layer from which down it alone is drawn of pictures in several tiles."""

KEPT_BYTES = 1 << 28
"""What decoded tiles may take before the one that was used least recently is let go."""

_MOST_TEXT = 200
"""Bytes that are shown of the name of the program that wrote a stream."""


class Survey(NamedTuple):
    """What all tiles hold together: number of seeds, bytes of each part, checksum of all decoded symbols."""

    seeds: int
    part_bytes: dict[str, float]
    symbol_crc: int


class Stream:
    """An opened `.sgi` stream: header and metadata at once, pixels on demand. A context manager.

    Of several tiles those are read and decoded that a region touches. `size` is the stream's length in bytes,
    `chunk_bytes` that of every chunk by its letter, frame included.
    """

    def __init__(self, source: bytes | BinaryIO, owned: BinaryIO | None = None, isa: str = "auto") -> None:
        self._owned, self._isa = owned, isa
        self._chunks = OpenedChunks(source)
        self.header, self.size, blobs = self._chunks.header, self._chunks.size, self._chunks.blobs
        self.chunk_bytes = self._chunks.chunk_bytes
        self.metadata = Metadata(icc=blobs.get("i"), exif=blobs.get("c"), xmp=blobs.get("x"), geo=blobs.get("g"))
        self.software = _printable(blobs.get("s", b""))
        self.grid = self.header.grid
        self._kept: OrderedDict[tuple[int, bool], DrawnTile] = OrderedDict()
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
        model = self.tile(0, 0).model
        if model is None:
            raise UsageError("there is no model: no pixel holds anything")
        return model

    @property
    def symbol_crc(self) -> int:
        """CRC-32 of every decoded symbol: equal on every machine."""
        return self.survey().symbol_crc

    @property
    def part_bytes(self) -> Lookup[str, float]:
        """Bytes of each part of the tiles, by information content."""
        return self.survey().part_bytes

    def survey(self, threads: int = 0) -> Survey:
        """Decodes all tiles, one at a time. Raises CorruptStreamError or LimitError."""
        if self._survey is None:
            parts: Counter[str] = Counter()
            crcs, seeds = [], 0
            for number in range(self.grid.count):
                payload = self.payload(number)
                tile = self.tile(0, threads) if self.grid.count == 1 else self._drawn(number, threads, payload)
                parts.update({name: bits / 8 for name, bits in tile.bits.items()})
                if self.header.masked is not None:
                    parts["mask"] += tile.mask_bytes
                crcs.append(tile.symbol_crc)
                seeds += 0 if tile.model is None else len(tile.model.layout)
            self._survey = Survey(seeds, dict(parts), joined_crc(crcs))
        return self._survey

    def render(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: tuple[int, int] | None = None,
        threads: int = 0,
    ) -> F32:
        """Samples [h, w, C] of a region (x, y, width, height in the picture's pixels), nominally 0..1, not clipped.

        `scale` multiplies the region's size, `size` states it instead. Enlarging draws the continuous function between
        the old pixels; shrinking filters, so that nothing aliases. Raises UsageError or LimitError.
        """
        view = self._view(region, scale, size)
        samples = np.empty((view.rows, view.columns, self.header.spec.channels), np.float32)
        self._draw(view, samples, None, threads)
        return samples

    def picture(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: tuple[int, int] | None = None,
        threads: int = 0,
    ) -> Picture:
        """The same as a picture in the source's depth and layout, with its metadata."""
        header = self.header
        view = self._view(region, scale, size)
        pixels = np.empty((view.rows, view.columns, header.spec.channels), header.sample_type)
        self._draw(view, pixels, _mapping(header), threads)
        return Picture(pixels, header.channels, header.sample_range, self._placed(view))

    def bands(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: tuple[int, int] | None = None,
        threads: int = 0,
    ) -> Bands:
        """The same picture in bands of rows from the top down, for what need not fit into memory."""
        view = self._view(region, scale, size, most=None)
        return Bands(self, view, threads)

    def _placed(self, view: View) -> Metadata:
        return replace(self.metadata, geo=geo_view(self.metadata.geo, view.x, view.y, view.sx, view.sy))

    def _view(
        self,
        region: Region | None,
        scale: float | None,
        size: tuple[int, int] | None,
        most: int | None = MAX_OUTPUT_SAMPLES,
    ) -> View:
        x, y, width, height = region or (0, 0, self.width, self.height)
        if width < 1 or height < 1 or x < 0 or y < 0 or x + width > self.width or y + height > self.height:
            raise UsageError(
                f"region {x},{y},{width},{height} is not inside the picture of {self.width}×{self.height} pixels"
            )
        columns, rows = _output_size(width, height, scale, size)
        if most is not None and columns * rows * self.header.spec.channels > most:
            raise LimitError(f"{columns}×{rows} pixels are too many for one call; decode regions or a smaller scale")
        return View(x, y, columns / width, rows / height, columns, rows)

    def _draw(self, view: View, out: NDArray[Any], mapping: Mapping | None, threads: int, top: int = 0) -> None:
        """Fills out [rows, columns, C] with samples of the view from its row `top` on."""
        alone = self.grid.count > 1 and self.header.spec.base_cell * max(view.sx, view.sy) <= BASE_ALONE
        for down in self.grid.down.segments(view.y, view.sy, top, len(out)):
            for across in self.grid.across.segments(view.x, view.sx, 0, view.columns):
                block = out[down.first : down.last, across.first : across.last]
                at = across.first, top + down.first
                tiles = [
                    self.tile(self.grid.number(column, row), threads, alone)
                    for row in _both(down)
                    for column in _both(across)
                ]
                if len(tiles) == 1:
                    tiles[0].draw(view, at, block, mapping, threads)
                else:
                    _blend(tiles, (down, across), view, at, block, mapping, threads)
                if mapping is not None and self.header.masked is not None:
                    clear(self.header, tiles[0], view, at, block)

    def payload(self, number: int) -> bytes:
        """What the chunk of a tile holds. Raises CorruptStreamError."""
        return self._chunks.tile(number)

    def tile(self, number: int, threads: int = 0, alone: bool = False) -> DrawnTile:
        """A decoded tile; `alone`: its base layer alone. Raises CorruptStreamError or LimitError."""
        key = number, alone
        if key not in self._kept:
            payload = self.payload(number)
            self._kept[key] = self._drawn(number, threads, payload, alone)
            if self.grid.count > 1:
                self._kept[key].forget_model()
            while len(self._kept) > _LEAST_KEPT and sum(tile.memory for tile in self._kept.values()) > KEPT_BYTES:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]

    def _drawn(self, number: int, threads: int, payload: bytes, alone: bool = False) -> DrawnTile:
        try:
            tile = DrawnTile(self.header, payload, threads, self._isa, alone)
        except StreamError as error:
            if self.grid.count == 1:
                raise
            raise type(error)(f"tile {number}: {error}") from error.__cause__
        return tile


_LEAST_KEPT = 4
"""Tiles that meet in a corner."""


class Bands:
    """A view of a stream, drawn band by band. width, height: in output pixels; metadata: those of the view."""

    def __init__(self, stream: Stream, view: View, threads: int) -> None:
        self._stream, self._view, self._threads = stream, view, threads
        self.width, self.height = view.columns, view.rows
        self.metadata = stream._placed(view)

    @property
    def rows(self) -> int:
        """Rows of a band; the last one may have fewer."""
        samples = self.width * self._stream.header.spec.channels
        return min(self.height, max(MIN_BAND_ROWS, BAND_SAMPLES // samples))

    def __iter__(self) -> Iterator[tuple[int, Picture]]:
        """First row and picture of each band."""
        header = self._stream.header
        for top in range(0, self.height, self.rows):
            shape = (min(self.rows, self.height - top), self.width, header.spec.channels)
            pixels = np.empty(shape, header.sample_type)
            self._stream._draw(self._view, pixels, _mapping(header), self._threads, top)
            yield top, Picture(pixels, header.channels, header.sample_range, self.metadata)


BAND_SAMPLES = 1 << 25
MIN_BAND_ROWS = 16
"""A band has so many samples, but no fewer rows."""


def _both(segment: Segment) -> tuple[int, ...]:
    return (segment.tile,) if segment.weight is None else (segment.tile, segment.tile + 1)


def _blend(
    tiles: list[DrawnTile],
    where: tuple[Segment, Segment],
    view: View,
    at: tuple[int, int],
    block: NDArray[Any],
    mapping: Mapping | None,
    threads: int,
) -> None:
    """Draws what two or four tiles share: each fades into the next."""
    down, across = (_shares(segment) for segment in where)
    total = np.zeros(block.shape, np.float32)
    drawn = np.empty(block.shape, np.float32)
    weights = [(w_down, w_across) for w_down in down for w_across in across]
    for tile, (w_down, w_across) in zip(tiles, weights, strict=True):
        tile.draw(view, at, drawn, None, threads)
        total += drawn * (w_down[:, None, None] * w_across[None, :, None])
    block[...] = total if mapping is None else _mapped(total, mapping, block.dtype)


def _shares(segment: Segment) -> list[F32]:
    if segment.weight is None:
        return [np.ones(segment.last - segment.first, np.float32)]
    return [1 - segment.weight, segment.weight]


def _mapped(values: F32, mapping: Mapping, dtype: np.dtype[Any]) -> NDArray[Any]:
    samples = mapping.low + mapping.span * np.clip(values, 0, 1)
    return samples.astype(dtype) if dtype.kind == "f" else np.rint(samples).astype(dtype)


def open_stream(source: str | Path | bytes | BinaryIO, isa: str = "auto") -> Stream:
    """Opens a stream from a path, bytes or a binary file object. Raises StreamError for what is none.

    isa: the instruction set to decode with: auto, avx512, avx2 or portable; ValueError later where this machine lacks
    it. Symbols are the same with all, pixels to less than a level of eight bits.
    """
    if isinstance(source, bytes) or not isinstance(source, str | Path):
        return Stream(source, isa=isa)
    file = Path(source).open("rb")  # noqa: SIM115 (the stream closes it)
    try:
        return Stream(file, file, isa)
    except BaseException:
        file.close()
        raise


def _mapping(header: Header) -> Mapping:
    """How values become samples: colours span the stated range, alpha its type."""
    low, high = (np.full(header.spec.channels, value, np.float64) for value in header.sample_range)
    alpha = alpha_index(header.channels)
    if alpha is not None:
        low[alpha], high[alpha] = full_range(header.sample_type)
    return Mapping(low.astype(np.float32), (high - low).astype(np.float32))


def _output_size(width: int, height: int, scale: float | None, size: tuple[int, int] | None) -> tuple[int, int]:
    if size is not None:
        if scale is not None:
            raise UsageError("give a scale or a size, not both")
        if min(size) < 1:
            raise UsageError(f"a size of {size[0]}×{size[1]} pixels holds no picture")
        return size
    if scale is None:
        return width, height
    if not (scale > 0 and math.isfinite(scale * max(width, height))):
        raise UsageError(f"a scale of {scale:g}; it must be a positive number")
    return max(1, round(width * scale)), max(1, round(height * scale))


def _printable(text: bytes) -> str:
    """The start of a text that somebody else wrote, without what could steer a terminal."""
    decoded = text[:_MOST_TEXT].decode("utf-8", "replace")
    return "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in decoded)
