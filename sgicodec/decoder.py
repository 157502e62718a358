"""From a stream to pixels: any region at any scale. Imports neither torch nor OpenImageIO."""

from __future__ import annotations

import math
from collections.abc import Mapping as Lookup
from itertools import product
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.container import SIGNATURE, ChunkReader
from sgicodec.bitstream.header import Header, decode_header
from sgicodec.bitstream.tile import DECODER_SHIFT, TileModel, read_tile
from sgicodec.errors import CorruptStreamError, LimitError, UsageError
from sgicodec.image import Metadata, Picture, full_range
from sgicodec.image.picture import alpha_index
from sgicodec.model.base_view import base_view
from sgicodec.model.gaussians import colour_matrix, gaussians_from_seeds
from sgicodec.model.processor import Processor
from sgicodec.model.quantize import FRACTION_BITS, step_fixed
from sgicodec.raster import Background, Mapping, NativeRasterizer, scaled

__all__ = ["CHUNKS", "MAX_OUTPUT_SAMPLES", "Region", "Stream", "open_stream"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Region = tuple[int, int, int, int]

CHUNKS = "Ticxs"
"""Chunks that this version knows: tile, ICC profile, EXIF as `c`amera data, XMP, and what wrote the file."""

MAX_OUTPUT_SAMPLES = 1 << 31
"""Most samples (pixels times channels) that one call renders."""

_BLOCK_SAMPLES = 1 << 27
_BLOCK_COLUMNS = 1 << 16
"""A picture is drawn in blocks of no more samples and columns, each of which looks at all Gaussians."""

_MOST_PAIRS = 1 << 26
"""Most (tile, Gaussian) pairs of a block; a sound one has a hundredth."""

_MOST_TEXT = 200
"""Bytes that are shown of the name of the program that wrote a stream."""


class _Gaussians(NamedTuple):
    means: F32
    covariances: F32
    colours: F32


class _View(NamedTuple):
    """Where it starts in the picture, output pixels for each of the picture's, and its size in output pixels."""

    x: int
    y: int
    sx: float
    sy: float
    columns: int
    rows: int


class Stream:
    """An opened `.sgi` stream: header and metadata at once, pixels on demand. A context manager.

    `size` is the stream's length in bytes, `chunk_bytes` that of every chunk by its letter, frame included.
    """

    def __init__(self, source: bytes | BinaryIO, owned: BinaryIO | None = None, isa: str = "auto") -> None:
        self._owned, self._isa = owned, isa
        reader = ChunkReader(source, CHUNKS)
        blobs: dict[str, bytes] = {}
        self.chunk_bytes: dict[str, int] = {"signature": len(SIGNATURE)}
        for chunk in reader:
            if chunk.kind in blobs:
                raise CorruptStreamError(f"{chunk}: there may be only one")
            blobs[chunk.kind] = chunk.payload()
            self.chunk_bytes[chunk.kind] = chunk.end - chunk.offset
            if chunk.kind == "H":
                self.header: Header = decode_header(blobs["H"])
        self.size = reader.end
        if "T" not in blobs:
            raise CorruptStreamError("there is no tile: nothing to draw")
        self._tile = blobs["T"]
        self.metadata = Metadata(icc=blobs.get("i"), exif=blobs.get("c"), xmp=blobs.get("x"))
        self.software = _printable(blobs.get("s", b""))
        self._model: TileModel | None = None
        self._gaussians: _Gaussians | None = None
        self._bits: dict[str, float] = {}
        self._symbol_crc = 0

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
        """The decoded model. Raises CorruptStreamError or LimitError."""
        return self._decoded(0)

    @property
    def symbol_crc(self) -> int:
        """CRC-32 of every decoded symbol of the tile: equal on every machine."""
        _ = self.model
        return self._symbol_crc

    @property
    def part_bytes(self) -> Lookup[str, float]:
        """Bytes of each part of the tile, by information content."""
        _ = self.model
        return {name: bits / 8 for name, bits in self._bits.items()}

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
        return Picture(pixels, header.channels, header.sample_range, self.metadata)

    def _view(self, region: Region | None, scale: float | None, size: tuple[int, int] | None) -> _View:
        x, y, width, height = region or (0, 0, self.width, self.height)
        if width < 1 or height < 1 or x < 0 or y < 0 or x + width > self.width or y + height > self.height:
            raise UsageError(
                f"region {x},{y},{width},{height} is not inside the picture of {self.width}×{self.height} pixels"
            )
        columns, rows = _output_size(width, height, scale, size)
        if columns * rows * self.header.spec.channels > MAX_OUTPUT_SAMPLES:
            raise LimitError(f"{columns}×{rows} pixels are too many for one call; decode regions or a smaller scale")
        return _View(x, y, columns / width, rows / height, columns, rows)

    def _draw(self, view: _View, out: NDArray[Any], mapping: Mapping | None, threads: int) -> None:
        """Fills out [rows, columns, C] with samples of the view, block by block: memory for one at a time."""
        spec, scale = self.header.spec, (view.sx, view.sy)
        gaussians, origin = self._prepared(threads), (view.x, view.y)
        if scale != (1.0, 1.0):
            gaussians, origin = _Gaussians(*scaled(*gaussians, scale, origin)), (0, 0)
        colours = self._base_colours()
        raster = NativeRasterizer(threads, self._isa, most_pairs=_MOST_PAIRS)
        width = min(view.columns, _BLOCK_COLUMNS)
        height = max(1, _BLOCK_SAMPLES // (width * spec.channels))
        for top, left in product(range(0, view.rows, height), range(0, view.columns, width)):
            block = out[top : top + height, left : left + width]
            background = None
            if spec.base_cell:
                size = block.shape[1], block.shape[0]
                seen = base_view(colours, spec.base_cell, (view.x, view.y), scale, (left, top), size, threads)
                background = Background(*seen)
            try:
                raster.draw(*gaussians, block, (origin[0] + left, origin[1] + top), background, mapping)
            except OverflowError as error:
                raise LimitError("the Gaussians cover too much of the picture; decode smaller regions") from error

    def _decoded(self, threads: int) -> TileModel:
        if self._model is None:
            self._model, walk = read_tile(self.header, self._tile, Processor(threads, self._isa))
            self._bits, self._symbol_crc = walk.bits, walk.crc
        return self._model

    def _prepared(self, threads: int) -> _Gaussians:
        if self._gaussians is None:
            model, spec = self._decoded(threads), self.header.spec
            decoders = {
                name: np.ldexp(weights.astype(np.float32), -DECODER_SHIFT) for name, weights in model.decoders.items()
            }
            arrays = gaussians_from_seeds(
                spec,
                model.decoded_values.astype(np.float32),
                model.layout.centre,
                model.layout.cell,
                decoders,
                np.array(colour_matrix(spec.channels), np.float32),
                np,
            )
            self._gaussians = _Gaussians(*(np.ascontiguousarray(a, dtype=np.float32) for a in arrays))
        return self._gaussians

    def _base_colours(self) -> F64:
        """The base layer's grid in the picture's channels [C, rows, columns]."""
        grid = self.model.base * float(step_fixed(np.array(self.model.base_step))) * 2.0**-FRACTION_BITS
        colours: F64 = np.tensordot(np.array(colour_matrix(self.header.spec.channels)).T, grid, axes=1)
        return colours


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
