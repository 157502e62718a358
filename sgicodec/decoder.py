"""From a stream to pixels: any region at any scale. Imports neither torch nor OpenImageIO."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.container import SIGNATURE, ChunkReader
from sgicodec.bitstream.header import Header, decode_header
from sgicodec.bitstream.tile import DECODER_SHIFT, TileModel, read_tile
from sgicodec.errors import CorruptStreamError, LimitError, UsageError
from sgicodec.image import Metadata, Picture, from_unit
from sgicodec.model.base import cubic_weights
from sgicodec.model.gaussians import colour_matrix, gaussians_from_seeds
from sgicodec.model.quantize import step_fixed
from sgicodec.raster import NativeRasterizer, scaled

__all__ = ["CHUNKS", "MAX_OUTPUT_SAMPLES", "Region", "Stream", "open_stream"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Region = tuple[int, int, int, int]

CHUNKS = "Ticxs"
"""Chunks that this version knows: tile, ICC profile, EXIF as `c`amera data, XMP, and what wrote the file."""

MAX_OUTPUT_SAMPLES = 1 << 31
"""Most samples (pixels times channels) that one call renders."""


class _Gaussians(NamedTuple):
    means: F32
    covariances: F32
    colours: F32


class Stream:
    """An opened `.sgi` stream: header and metadata at once, pixels on demand. A context manager.

    `size` is the stream's length in bytes, `chunk_bytes` that of every chunk by its letter, frame included.
    """

    def __init__(self, source: bytes | BinaryIO, owned: BinaryIO | None = None) -> None:
        self._owned = owned
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
        self.software = blobs.get("s", b"").decode("utf-8", "replace")
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
        if self._model is None:
            self._model, walk = read_tile(self.header, self._tile)
            self._bits, self._symbol_crc = walk.bits, walk.crc
        return self._model

    @property
    def symbol_crc(self) -> int:
        """CRC-32 of every decoded symbol of the tile: equal on every machine."""
        _ = self.model
        return self._symbol_crc

    @property
    def part_bytes(self) -> Mapping[str, float]:
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
        x, y, width, height = self._checked(region)
        columns, rows = _output_size(width, height, scale, size)
        channels = self.header.spec.channels
        if columns * rows * channels > MAX_OUTPUT_SAMPLES:
            raise LimitError(f"{columns}×{rows} pixels are too many for one call; decode regions or a smaller scale")
        sx, sy = columns / width, rows / height
        gaussians = self._prepared()
        unscaled = (sx, sy) == (1.0, 1.0)
        view = gaussians if unscaled else scaled(*gaussians, (sx, sy), (x, y))
        try:
            image = NativeRasterizer(threads).forward(*view, columns, rows, (x, y) if unscaled else (0, 0))
        except OverflowError as error:
            raise LimitError("the Gaussians cover too much of the picture; decode smaller regions") from error
        if self.header.spec.base_cell:
            image += self._base(x, y, sx, sy, columns, rows)
        return np.ascontiguousarray(image.transpose(1, 2, 0))

    def picture(
        self,
        region: Region | None = None,
        scale: float | None = None,
        size: tuple[int, int] | None = None,
        threads: int = 0,
    ) -> Picture:
        """The same as a picture in the source's depth and layout, with its metadata."""
        header = self.header
        unit = self.render(region, scale, size, threads)
        return from_unit(unit, header.channels, header.sample_type, header.sample_range, self.metadata)

    def _checked(self, region: Region | None) -> Region:
        if region is None:
            return 0, 0, self.width, self.height
        x, y, width, height = region
        if width < 1 or height < 1 or x < 0 or y < 0 or x + width > self.width or y + height > self.height:
            raise UsageError(
                f"region {x},{y},{width},{height} is not inside the picture of {self.width}×{self.height} pixels"
            )
        return region

    def _prepared(self) -> _Gaussians:
        if self._gaussians is None:
            model, spec = self.model, self.header.spec
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

    def _base(self, x: int, y: int, sx: float, sy: float, columns: int, rows: int) -> F32:
        spec, model = self.header.spec, self.model
        grid = model.base * float(step_fixed(np.array(model.base_step))) * 2.0**-24
        across = _area_weights(x, sx, columns, grid.shape[2], spec.base_cell)
        down = _area_weights(y, sy, rows, grid.shape[1], spec.base_cell)
        opponent = np.array(colour_matrix(spec.channels))
        colours = np.tensordot(opponent.T, grid, axes=1)
        return np.asarray(down @ (colours @ across.T), np.float32)


def open_stream(source: str | Path | bytes | BinaryIO) -> Stream:
    """Opens a stream from a path, bytes or a binary file object. Raises StreamError for what is none."""
    if isinstance(source, bytes) or not isinstance(source, str | Path):
        return Stream(source)
    file = Path(source).open("rb")  # noqa: SIM115 (the stream closes it)
    try:
        return Stream(file, owned=file)
    except BaseException:
        file.close()
        raise


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


def _area_weights(start: int, scale: float, count: int, cells: int, cell: int) -> F64:
    """Interpolation weights [count, cells] of the base layer, averaged over each output pixel's extent."""
    taps = max(1, math.ceil(4 / (scale * cell)))
    weights: F64 = np.zeros((count, cells))
    for tap in range(taps):
        weights += cubic_weights(start + (np.arange(count) + (tap + 0.5) / taps) / scale, cells, cell)
    return weights / taps
