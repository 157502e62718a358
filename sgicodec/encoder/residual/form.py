"""What a residual layer states of all its blocks: grids, tables and a palette (docs/format.md, "Residual layer")."""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.varint import encode_varint
from sgicodec.encoder.residual.blocks import DistinctPixels, Repeats
from sgicodec.encoder.residual.grids import Floats, Grid, Integers, with_table
from sgicodec.metadata.layouts import alpha_index

_BITS, _VIEWS, _PALETTE, _CELLS, _ALPHA_ALONE, _BANDS = 1, 2, 4, 8, 16, 32
"""Flags of a layer."""


def residual_form(
    header: Header,
    windows: Iterable[NDArray[Any]],
    max_error: float,
    *,
    exact_views: bool = False,
    has_cells: bool = False,
    bands: Collection[int] = (),
    off: float = 0,
) -> bytes:
    """What a residual layer states of all its blocks, by the samples [h, w, C] of all windows of its picture, which are
    off by so much already; the rest as in `Layer`. It has tables of samples where it takes fewer bits with them.
    """
    survey = _Survey(header, exact_views, bands)
    for pixels in windows:
        survey.see(pixels)
    flags = exact_views * _VIEWS + has_cells * _CELLS
    plain, tabled = (survey.form(max_error, max_error - off, flags, has_tables) for has_tables in (False, True))
    return plain if plain == tabled else min(plain, tabled, key=survey.bits)


def coded_bits(samples: NDArray[np.float32], header: Header, form: bytes, cells: NDArray[np.uint8]) -> float:
    """Bits of a block [h, w, C] in a layer of this form, whatever is drawn below. cells: 1 for those that it shows."""
    return _native.code_residual(samples, np.zeros_like(samples), encode_header(header), form, cells)[2]


class _Survey:
    """What windows of a picture tell of its samples; has_colours: whether its colours are of interest; bands: those
    that windows have, none for all.
    """

    def __init__(self, header: Header, has_colours: bool, bands: Collection[int]) -> None:
        self._header, self._is_float = header, header.sample_type == "float32"
        self._bands = bands
        self._alpha, self._has_colours = alpha_index(header.channels), has_colours and not self._is_float
        count = len(bands) or header.spec.channels
        self._channels: list[Floats | Integers] = [
            Floats() if self._is_float else Integers(header.sample_type) for _ in range(count)
        ]
        self._repeats, self._palette = Repeats(), _Palette()
        self._most, self._part = -1, np.zeros((0, 0, 0), np.float32)

    def see(self, pixels: NDArray[Any]) -> None:
        """One more window [h, w, C]."""
        others = self._repeats.see(pixels)
        if self._has_colours:
            self._palette.see(pixels[others])
        count = int(np.count_nonzero(others))
        if count > self._most:
            self._most, self._part = count, np.array(pixels[:_PART, :_PART], np.float32, order="C")
        for number, channel in enumerate(self._channels):
            samples = pixels[..., number].ravel()
            is_measured = np.isfinite(samples)
            if self._header.blank is not None and number != self._alpha:
                is_measured &= samples != self._header.blank
            channel.see(samples[is_measured])

    def form(self, stated: float, max_error: float, flags: int, has_tables: bool) -> bytes:
        """The form of a layer of which no sample is off by more; it states another greatest error."""
        has_few = self._palette.is_small(self._repeats.pixels)
        plain: list[Grid | None] = []
        tables: list[Grid | None] = []
        for number, channel in enumerate(self._channels):
            most_off = max_error if self._is_float or number != self._alpha else 0
            plain.append(channel.grid(most_off, self._header.blank))
            tables.append(with_table(channel, plain[-1], most_off) if has_tables and not has_few else None)
        has_bits = any(not (grid or table) for grid, table in zip(plain, tables, strict=True))
        grids = [
            table or (channel.exact_grid() if has_bits or grid is None else self._even(grid))
            for channel, grid, table in zip(self._channels, plain, tables, strict=True)
        ]
        has_palette = has_few and not any(grid.max_error for grid in grids)
        flags |= bool(self._bands) * _BANDS | has_bits * _BITS | has_palette * _PALETTE
        head = struct.pack("<d", stated) + encode_varint(flags)
        if self._bands:
            head += bytes(band in self._bands for band in range(self._header.spec.channels))
        return head + b"".join(grid.encode() for grid in grids) + (self._palette.encode(grids) if has_palette else b"")

    def _even(self, grid: Grid) -> Grid:
        """A grid that lets pixels that repeat others do so, where most do; a coarse one must not hold nodata."""
        if not self._repeats.are_usual:
            return grid
        return grid.coarser() if self._header.blank is None else replace(grid, max_error=0)

    def bits(self, form: bytes) -> float:
        """What a layer of this form takes, by the part of the picture that was kept."""
        height, width, _ = self._part.shape
        cells = np.ones(-(-height // _native.RESIDUAL_CELL) * -(-width // _native.RESIDUAL_CELL), np.uint8)
        coded = coded_bits(self._part, self._header, form, cells)
        return 8 * len(form) + coded * self._repeats.pixels / (height * width)


_PART = 256
"""Pixels of a side of the part of a picture by which forms are compared."""


def alpha_form(largest: int) -> bytes:
    """The same of a layer of alpha alone, of samples up to this."""
    return struct.pack("<d", 0.0) + encode_varint(_ALPHA_ALONE) + Grid(0.0, 1.0, largest, is_whole=True).encode()


_PIXELS_OF_COLOUR = 500
"""Without as many, a palette takes more than it saves: 0.6 kB of a page of 384×384 pixels in 200 colours."""


class _Palette(DistinctPixels):
    """The colours of a picture of whole numbers, while they are few."""

    def __init__(self) -> None:
        super().__init__(_native.MAX_PALETTE)

    def is_small(self, pixels: int) -> bool:
        """Whether all colours are known, and few for so many pixels."""
        return 0 < len(self.known) <= min(_native.MAX_PALETTE, pixels // _PIXELS_OF_COLOUR)

    def encode(self, grids: list[Grid]) -> bytes:
        """The number of colours, and their values, from the darkest on."""
        colours = sorted(self.known.tolist(), key=lambda colour: (sum(colour), colour))
        values = [
            round((sample - grid.base) / grid.step)
            for colour in colours
            for sample, grid in zip(colour, grids, strict=True)
        ]
        return encode_varint(len(colours)) + b"".join(map(encode_varint, values))
