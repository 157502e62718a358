"""The tile renderer: one tile's decoded model, which renders any part of itself at any scale."""

from __future__ import annotations

import zlib
from collections.abc import Mapping as Lookup
from itertools import product
from math import ceil, floor, prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import DECODER_SHIFT, TileModel, read_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.decoder.view import View
from sgicodec.device import Device
from sgicodec.errors import LimitError
from sgicodec.model.base import base_colours
from sgicodec.model.base_view import base_view
from sgicodec.model.gaussians import model_gaussians
from sgicodec.model.luma_space import from_luma_space
from sgicodec.model.texture import TextureLayer
from sgicodec.raster import Background, Mapping, NativeRasterizer, nothing_behind, scaled

__all__ = ["BLOCK_COLUMNS", "BLOCK_SAMPLES", "TEXTURED_SAMPLES", "TileRenderer", "joined_crc"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

BLOCK_SAMPLES = 1 << 27
BLOCK_COLUMNS = 1 << 16
"""A picture is drawn in blocks of no more samples and columns, each of which looks at all Gaussians."""

TEXTURED_SAMPLES = 1 << 23
"""And where there is texture in blocks of fewer: it is drawn to floats first."""

_MOST_PAIRS = 1 << 24
"""Most (tile, Gaussian) pairs of a block; a sound one has a tenth at most."""


_WHOLE_SAMPLES = 1 << 18
"""A tile of a reduced view that has no more samples is drawn at once, whatever part is asked for: each part would have
to look at all of its Gaussians again."""


class _Whole(NamedTuple):
    """A tile as a view shows it [h, w, C], and where that is in the view."""

    view: View
    left: int
    top: int
    samples: F32


class _Gaussians(NamedTuple):
    means: F32
    covariances: F32
    colours: F32


class TileRenderer:
    """Decodes the payload of a chunk T. Raises CorruptStreamError or LimitError.

    x, y: where the tile begins in the picture. mask: [h, w] which of its pixels hold nothing, None if all hold
    something; mask_bytes: what it and the tile's number take.
    """

    def __init__(self, header: Header, payload: bytes, device: Device) -> None:
        chunk = decode_tile_chunk(header, payload)
        self.x, self.y, _, _ = header.grid.rect(chunk.number)
        self.mask = chunk.mask
        self.mask_bytes = len(payload) - len(chunk.model or b"")
        self.header = own = header.of_tile(chunk.number)
        self.model: TileModel | None = None
        self.bits: Lookup[str, float] = {}
        self.symbol_crc = 0
        self.gaussians, self._colours = _nothing(own), np.zeros((own.spec.channels, 0, 0))
        self._texture: TextureLayer | None = None
        self._scaled: tuple[View, _Gaussians] | None = None
        self._whole: _Whole | None = None
        if chunk.model is None:
            return
        self.model, coder = read_tile(own, chunk.model, device)
        self.bits, self.symbol_crc = coder.bits, coder.crc
        self.gaussians = _drawable(own, self.model, device)
        self._colours = base_colours(self.model.base, self.model.base_step)
        if own.spec.luma_space:
            self._leave_luma_space()
        self._texture = None if self.model.texture is None else self.model.texture.layer()

    def _leave_luma_space(self) -> None:
        """Mixes all colours so that what is drawn is red, green and blue. Texture does so where it is drawn."""
        mix = from_luma_space(self.header.spec.channels)
        means, covariances, colours = self.gaussians
        self.gaussians = _Gaussians(means, covariances, np.ascontiguousarray(colours @ mix.T, np.float32))
        self._colours = np.tensordot(mix, self._colours, axes=1)

    @property
    def memory(self) -> int:
        """Bytes that it holds, about."""
        drawing = (2 if self._scaled else 1) * sum(array.nbytes for array in self.gaussians)
        model = 16 * len(self.gaussians.means) * self.header.spec.attributes if self.model else 0
        drawing += 0 if self._whole is None else self._whole.samples.nbytes
        if self._texture is not None:
            drawing += self._texture.memory
            model += 0 if self.model is None or self.model.texture is None else self.model.texture.symbols.nbytes
        return drawing + model + self._colours.nbytes + (0 if self.mask is None else self.mask.nbytes)

    def release_model(self) -> None:
        """Keeps only what draws."""
        self.model = None

    def prepare(self, view: View, device: Device) -> None:
        """Does what `draw` would have to do first."""
        if self._drawn_whole(view, device) is None:
            self._seen(view)

    def draw(self, view: View, at: tuple[int, int], out: NDArray[Any], mapping: Mapping | None, device: Device) -> None:
        """Fills out [h, w, C] with the samples of the view from its pixel `at` (x, y) on."""
        whole = self._drawn_whole(view, device)
        if whole is not None:
            rows, columns, _ = out.shape
            left, top = at[0] - whole.left, at[1] - whole.top
            known_rows, known_columns, _ = whole.samples.shape
            if 0 <= left <= known_columns - columns and 0 <= top <= known_rows - rows:
                part = whole.samples[top : top + rows, left : left + columns]
                out[...] = part if mapping is None else mapping.samples(part, out.dtype)
                return
        self._draw(view, at, out, mapping, device)

    def _drawn_whole(self, view: View, device: Device) -> _Whole | None:
        """What a reduced view shows of the tile, if that is little."""
        if max(view.sx, view.sy) >= 1:
            return None
        if self._whole is None or self._whole.view != view:
            left, right = _extent(self.x - view.x, self.header.width, view.sx, view.columns)
            top, bottom = _extent(self.y - view.y, self.header.height, view.sy, view.rows)
            shape = bottom - top, right - left, self.header.spec.channels
            if not 0 < prod(shape) <= _WHOLE_SAMPLES:
                return None
            samples = np.empty(shape, np.float32)
            self._draw(view, (left, top), samples, None, device)
            self._whole = _Whole(view, left, top, samples)
        return self._whole

    def _draw(
        self, view: View, at: tuple[int, int], out: NDArray[Any], mapping: Mapping | None, device: Device
    ) -> None:
        """Draws block by block."""
        spec, scale = self.header.spec, (view.sx, view.sy)
        start = view.x - self.x, view.y - self.y
        gaussians, origin = self._seen(view), (int(start[0]), int(start[1])) if _is_plain(view) else (0, 0)
        raster = NativeRasterizer(device, most_pairs=_MOST_PAIRS)
        rows, columns, _ = out.shape
        width = min(columns, BLOCK_COLUMNS)
        most = BLOCK_SAMPLES if self._texture is None else TEXTURED_SAMPLES
        height = max(1, most // (width * spec.channels))
        for top, left in product(range(0, rows, height), range(0, columns, width)):
            block = out[top : top + height, left : left + width]
            first = at[0] + left, at[1] + top
            background = self._background(start, scale, first, (block.shape[1], block.shape[0]), device)
            try:
                raster.draw(*gaussians, block, (origin[0] + first[0], origin[1] + first[1]), background, mapping)
            except OverflowError as error:
                raise LimitError("the Gaussians cover too much of the picture; decode smaller regions") from error

    def _background(
        self,
        start: tuple[float, float],
        scale: tuple[float, float],
        first: tuple[int, int],
        size: tuple[int, int],
        device: Device,
    ) -> Background | None:
        """Base layer and texture of a block, whichever there is; parameters as of `base_view`."""
        channels, cell = self.header.spec.channels, self.header.spec.base_cell
        texture = None
        if self._texture is not None:
            texture = self._texture.draw(start, scale, first, size, device, luma_space=self.header.spec.luma_space)
        if self._colours.size:
            return Background(*base_view(self._colours, cell, start, scale, first, size, device), texture)
        return None if texture is None else nothing_behind(channels, texture)

    def _seen(self, view: View) -> _Gaussians:
        if _is_plain(view):
            return self.gaussians
        key = view._replace(columns=0, rows=0)
        if self._scaled is None or self._scaled[0] != key:
            start = float(view.x - self.x), float(view.y - self.y)
            self._scaled = key, _Gaussians(*scaled(*self.gaussians, (view.sx, view.sy), start))
        return self._scaled[1]


def _is_plain(view: View) -> bool:
    """Whether its pixels are the picture's."""
    return (view.sx, view.sy) == (1.0, 1.0) and float(view.x).is_integer() and float(view.y).is_integer()


def _extent(start: float, size: int, scale: float, most: int) -> tuple[int, int]:
    """First and last output pixel and one on, out of `most`, of what begins at `start` and has `size` pixels."""
    return max(0, floor(start * scale)), min(most, ceil((start + size) * scale))


def _nothing(header: Header) -> _Gaussians:
    return _Gaussians(*(np.zeros((0, size), np.float32) for size in (2, 3, header.spec.channels)))


def _drawable(header: Header, model: TileModel, device: Device) -> _Gaussians:
    spec = header.spec
    decoders = {name: np.ldexp(weights.astype(np.float32), -DECODER_SHIFT) for name, weights in model.decoders.items()}
    return _Gaussians(*model_gaussians(spec, model.decoded_values, model.layout, decoders, device))


def joined_crc(crcs: list[int]) -> int:
    """One checksum of the symbols of several tiles; that of a single one is its own."""
    return crcs[0] if len(crcs) == 1 else zlib.crc32(np.array(crcs, "<u4").tobytes())
