"""The residual layer: what a stream lacks to be its picture, or near it (docs/format.md, "Residual layer")."""

from __future__ import annotations

import zlib
from collections import deque
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.varint import encode_varint
from sgicodec.decoder.stream import Stream
from sgicodec.device import Device
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.residual.blocks import block_rects
from sgicodec.encoder.residual.form import alpha_form, coded_bits, residual_form
from sgicodec.encoder.residual.graphic_cells import Cells, cells_in, cells_shape, stacked_cells
from sgicodec.errors import PictureError
from sgicodec.model.tile_grid import Rect

_CRC_BYTES = 4


@dataclass(frozen=True)
class ResidualLayer:
    """What a residual layer brings a stream to: the picture of `windows` but for `max_error` levels; floats by so much.
    Alpha of 8 and 16 bits is exact. exact_views: whether it shows every view. cells [rows, columns]: where it does, if
    not everywhere. bands: those that it shows, from 0 on, none for all. includes_error: whether samples of `windows`
    are off by so much already. is_alpha: whether it shows alpha alone, in every view. Raises PictureError where samples
    of the source have too many bits for that.
    """

    windows: Windows
    max_error: float
    exact_views: bool = False
    cells: Cells | None = None
    bands: tuple[int, ...] = ()
    includes_error: bool = False
    is_alpha: bool = False

    @classmethod
    def exact(cls, windows: Windows, *, exact_views: bool = False, bands: tuple[int, ...] = ()) -> ResidualLayer:
        """One without loss, but for what 32 bits of samples lack."""
        return cls(windows, windows.shape.rounding, exact_views, bands=bands, includes_error=True)

    def __post_init__(self) -> None:
        off = self._rounding
        if off >= self.max_error and off > 0 and not (self.is_alpha or self.includes_error):
            raise PictureError(
                f"its samples do not fit 32-bit floats, which are off by up to {off:g}: --lossless is not possible, "
                f"--max-error is above that"
            )

    @property
    def _rounding(self) -> float:
        """That of the source; clipped colours are refused where a layer is asked for (`check_clipped`)."""
        return 0.0 if self.windows.shape.is_clipped else self.windows.shape.rounding

    def form(self, header: Header, rects: Iterable[Rect]) -> bytes:
        """What it states of all blocks, by these."""
        if self.is_alpha:
            return alpha_form(np.iinfo(header.sample_type).max)
        windows = (self._shown(rect) for rect in rects)
        return residual_form(
            header,
            windows,
            self.max_error,
            exact_views=self.exact_views,
            has_cells=self.cells is not None,
            bands=self.bands,
            off=self.max_error if self.includes_error else self._rounding,
        )

    def of(self, rect: Rect) -> Cells:
        """Which cells of a block it shows."""
        return np.ones(cells_shape(*rect[2:]), np.bool_) if self.cells is None else self.cells[cells_in(rect)]

    def samples(self, rect: Rect) -> NDArray[np.float32]:
        """Those [h, w, c] that it has of a block."""
        return _samples(self._with_bands(self.windows.read(*rect).pixels))

    def drawn(self, rect: Rect, stream: Stream) -> NDArray[np.float32]:
        """What these are without it."""
        if self.is_alpha:
            return np.zeros((*rect[:1:-1], 1), np.float32)
        return _samples(self._with_bands(stream.picture(rect).pixels))

    def _with_bands(self, pixels: NDArray[Any]) -> NDArray[Any]:
        bands = (-1,) if self.is_alpha else self.bands
        return pixels[..., bands] if bands else pixels

    def _shown(self, rect: Rect) -> NDArray[Any]:
        """Pixels that it shows of a block: of cells, one below the other."""
        pixels = self._with_bands(self.windows.read(*rect).pixels)
        return pixels if self.cells is None else stacked_cells(pixels, self.cells[cells_in(rect)])


def residual_payload(stream: Stream, layer: ResidualLayer, device: Device) -> bytes:
    """The payload of a residual layer for an opened stream. A layer that the stream has is left aside.

    Raises PictureError for a picture that is not the stream's.
    """
    header = stream.header
    _check_shape(header, layer.windows)
    stream.lossy = True
    form = layer.form(header, block_rects(header))
    blocks, whole = [], encode_header(header)
    with ThreadPoolExecutor(device.cores) as pool:
        waiting: deque[Future[_Block]] = deque()
        for rect in block_rects(header):
            given, drawn = layer.samples(rect), layer.drawn(rect, stream)
            waiting.append(pool.submit(_coded, given, drawn, whole, form, layer.of(rect)))
            if len(waiting) > device.cores:
                blocks.append(waiting.popleft().result())
        blocks += [block.result() for block in waiting]
    table = [encode_varint(len(block.data)) + block.crc.to_bytes(_CRC_BYTES, "little") for block in blocks]
    return b"".join([form, *table, *(block.data for block in blocks)])


def bits_of_blocks(header: Header, layer: ResidualLayer, rects: Iterable[Rect]) -> float:
    """What a residual layer takes of these blocks, whatever is drawn below."""
    rects = list(rects)
    form = layer.form(header, rects)
    return sum(coded_bits(layer.samples(rect), header, form, _flags(layer.of(rect))) for rect in rects)


class _Block(NamedTuple):
    """A coded block, and the CRC-32 of its samples."""

    data: bytes
    crc: int


def _coded(
    samples: NDArray[np.float32], drawn: NDArray[np.float32], header: bytes, form: bytes, cells: Cells
) -> _Block:
    if not cells.any():
        return _Block(b"", zlib.crc32(drawn.tobytes()))
    return _Block(*_native.code_residual(samples, drawn, header, form, _flags(cells))[:2])


def _flags(cells: Cells) -> NDArray[np.uint8]:
    return cells.ravel().astype(np.uint8)


def _samples(pixels: NDArray[Any]) -> NDArray[np.float32]:
    return np.ascontiguousarray(pixels, np.float32)


def _check_shape(header: Header, windows: Windows) -> None:
    shape = windows.shape
    found = (shape.width, shape.height, shape.bands, str(shape.dtype))
    wanted = (header.width, header.height, header.spec.channels, header.sample_type)
    if found != wanted:
        names = [
            f"{width}×{height} pixels, {bands} channels, {dtype}" for width, height, bands, dtype in (found, wanted)
        ]
        raise PictureError(f"the picture has {names[0]}, the stream {names[1]}")
