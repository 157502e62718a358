"""The grids on which a residual layer codes the samples of a picture (docs/format.md, "Residual layer")."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.symbol_writer import range_coded
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.varint import encode_varint
from sgicodec.metadata.layouts import alpha_index
from sgicodec.model.tile_grid import Rect

__all__ = ["Repeats", "alpha_form", "block_rects", "coded_bits", "residual_form"]

_SCALES = (1, 10, 100, 1000, 10_000, 2, 4, 16, 64, 256, 1024, 4096)
"""Floats are often whole multiples of one over one of these."""
_BITS, _VIEWS, _PALETTE, _CELLS, _ALPHA_ALONE = 1, 2, 4, 8, 16
"""Flags of a layer."""


@dataclass(frozen=True)
class _Grid:
    """base, step: value j stands for base + j · step; most: the largest value; max_error: by how much one is off.

    table: the samples that occur, rising, if values stand for these; is_whole: whether samples are whole numbers.
    """

    base: float
    step: float
    most: int
    max_error: int = 0
    table: NDArray[np.float32] | None = None
    is_whole: bool = False

    def coarser(self) -> _Grid:
        """One on which no sample is off by more, and samples that are equal stay equal."""
        factor = 2 * self.max_error + 1
        most, rest = divmod(self.most, factor)
        base, step = self.base + min(rest, self.max_error) * self.step, factor * self.step
        return self if factor == 1 else replace(self, base=base, step=step, most=most, max_error=0)

    def encode(self) -> bytes:
        reals = struct.pack("<2d", self.base, self.step)
        numbers = encode_varint(int(self.base)) + encode_varint(int(self.step)) if self.is_whole else reals
        return numbers + encode_varint(self.most) + encode_varint(self.max_error) + self._encode_table()

    def _encode_table(self) -> bytes:
        if self.table is None:
            return encode_varint(0)
        stated = _native.code_table(not self.is_whole, self.base, self.step, self.most, self.table)
        return encode_varint(len(coded := range_coded(*stated))) + coded


def residual_form(
    header: Header,
    windows: Iterable[NDArray[Any]],
    max_error: float,
    *,
    exact_views: bool = False,
    has_cells: bool = False,
    off: float = 0,
) -> bytes:
    """What a residual layer states of all its blocks, by the samples [h, w, C] of all windows of its picture, which are
    off by so much already; the rest as in `Layer`. It has tables of samples where it takes fewer bits with them.
    """
    survey = _Survey(header, exact_views)
    for pixels in windows:
        survey.see(pixels)
    flags = exact_views * _VIEWS + has_cells * _CELLS
    plain, tabled = (survey.form(max_error, max_error - off, flags, has_tables) for has_tables in (False, True))
    return plain if plain == tabled else min(plain, tabled, key=survey.bits)


def coded_bits(samples: NDArray[np.float32], header: Header, form: bytes, cells: NDArray[np.uint8]) -> float:
    """Bits of a block [h, w, C] in a layer of this form, whatever is drawn below. cells: 1 for those that it shows."""
    coded, ones, _ = _native.code_residual(samples, np.zeros_like(samples), encode_header(header), form, cells)
    return -float(np.log2(np.where(coded, ones, 65536 - ones) / 65536).sum())


class _Survey:
    """What windows of a picture tell of its samples; has_colours: whether its colours are of interest."""

    def __init__(self, header: Header, has_colours: bool) -> None:
        self._header, self._is_float = header, header.sample_type == "float32"
        self._alpha, self._has_colours = alpha_index(header.channels), has_colours and not self._is_float
        self._channels: list[_Floats | _Integers] = [
            _Floats() if self._is_float else _Integers(header.sample_type) for _ in range(header.spec.channels)
        ]
        self._repeats, self._palette, self._most, self._part = (
            Repeats(),
            _Palette(),
            -1,
            np.zeros((0, 0, 0), np.float32),
        )

    def see(self, pixels: NDArray[Any]) -> None:
        """One more window [h, w, C]."""
        others = self._repeats.see(pixels)
        if self._has_colours:
            self._palette.see(pixels[others])
        if np.count_nonzero(others) > self._most:
            self._most, self._part = int(np.count_nonzero(others)), pixels[:_PART, :_PART].astype(np.float32)
        for number, channel in enumerate(self._channels):
            samples = pixels[..., number].ravel()
            is_measured = np.isfinite(samples)
            if self._header.blank is not None and number != self._alpha:
                is_measured &= samples != self._header.blank
            channel.see(samples[is_measured])

    def form(self, stated: float, max_error: float, flags: int, has_tables: bool) -> bytes:
        """The form of a layer of which no sample is off by more; it states another greatest error."""
        has_few, is_masked = self._palette.is_small(self._repeats.pixels), self._header.blank is not None
        grids: list[_Grid | None] = []
        for number, channel in enumerate(self._channels):
            most_off = max_error if self._is_float or number != self._alpha else 0
            grid = channel.grid(most_off, self._header.blank)
            table = _with_table(channel, grid, most_off) if has_tables and not has_few else None
            if grid and not table and self._repeats.are_usual:  # a coarse grid must not hold nodata
                grid = replace(grid, max_error=0) if is_masked else grid.coarser()
            grids.append(table or grid)
        if None in grids:
            flags |= _BITS
            grids = [
                grid if grid and grid.table is not None else channel.exact_grid()
                for grid, channel in zip(grids, self._channels, strict=True)
            ]
        found = [grid for grid in grids if grid is not None]
        has_palette = has_few and not any(grid.max_error for grid in found)
        head = struct.pack("<d", stated) + encode_varint(flags | has_palette * _PALETTE)
        return head + b"".join(grid.encode() for grid in found) + (self._palette.encode(found) if has_palette else b"")

    def bits(self, form: bytes) -> float:
        """What a layer of this form takes, by the part of the picture that was kept."""
        height, width, _ = self._part.shape
        cells = np.ones(-(-height // _native.RESIDUAL_CELL) * -(-width // _native.RESIDUAL_CELL), np.uint8)
        coded = coded_bits(np.ascontiguousarray(self._part), self._header, form, cells)
        return 8 * len(form) + coded * self._repeats.pixels / (height * width)


_PART = 256
"""Pixels of a side of the part of a picture by which forms are compared."""


def alpha_form(largest: int) -> bytes:
    """The same of a layer of alpha alone, of samples up to this."""
    return struct.pack("<d", 0.0) + encode_varint(_ALPHA_ALONE) + _Grid(0.0, 1.0, largest, is_whole=True).encode()


def block_rects(header: Header) -> Iterator[Rect]:
    """The blocks of a picture, in rows."""
    side = _native.RESIDUAL_BLOCK
    for y in range(0, header.height, side):
        for x in range(0, header.width, side):
            yield x, y, min(side, header.width - x), min(side, header.height - y)


class Repeats:
    """How many pixels there are, and how many are others than the one to their left."""

    def __init__(self) -> None:
        self.pixels = self.others = 0

    def see(self, pixels: NDArray[Any]) -> NDArray[np.bool_]:
        """More pixels [h, w, C]; gives which are not [h, w]."""
        others = np.ones(pixels.shape[:2], np.bool_)
        others[:, 1:] = False
        for channel in range(pixels.shape[2]):
            others[:, 1:] |= pixels[:, 1:, channel] != pixels[:, :-1, channel]
        self.pixels += others.size
        self.others += int(np.count_nonzero(others))
        return others

    @property
    def are_usual(self) -> bool:
        """Whether more than half are, as in text, line art and screens."""
        return 2 * self.others < self.pixels


_PIXELS_OF_COLOUR = 500
"""Without as many, a palette takes more than it saves: 0.6 kB of a page of 384×384 pixels in 200 colours."""


class _Palette:
    """The colours of a picture of whole numbers, while they are few."""

    def __init__(self) -> None:
        self._colours: NDArray[Any] | None = None

    def see(self, pixels: NDArray[Any]) -> None:
        """More pixels [n, C]."""
        if self._colours is None or len(self._colours) <= _native.MAX_PALETTE:
            known = [] if self._colours is None else [self._colours]
            self._colours = np.unique(np.concatenate([*known, pixels]), axis=0)

    def is_small(self, pixels: int) -> bool:
        """Whether all colours are known, and few for so many pixels."""
        count = _native.MAX_PALETTE + 1 if self._colours is None else len(self._colours)
        return count <= min(_native.MAX_PALETTE, pixels // _PIXELS_OF_COLOUR)

    def encode(self, grids: list[_Grid]) -> bytes:
        """The number of colours, and their values, from the darkest on."""
        colours = (
            [] if self._colours is None else sorted(self._colours.tolist(), key=lambda colour: (sum(colour), colour))
        )
        values = [
            round((sample - grid.base) / grid.step)
            for colour in colours
            for sample, grid in zip(colour, grids, strict=True)
        ]
        return encode_varint(len(colours)) + b"".join(map(encode_varint, values))


_MAX_TABLE = _native.MAX_TABLE_STEPS + 1


class _Integers:
    """The whole numbers that occur in a channel."""

    def __init__(self, sample_type: str) -> None:
        self._occurs = np.zeros(np.iinfo(sample_type).max + 1, np.bool_)

    def see(self, samples: NDArray[Any]) -> None:
        """More samples of the channel."""
        self._occurs[samples] = True

    def distinct(self) -> NDArray[np.float64]:
        """All of them, rising."""
        return np.flatnonzero(self._occurs).astype(np.float64)

    def exact_grid(self) -> _Grid:
        """One with all samples on it."""
        return self.grid(0, None)

    def grid(self, max_error: float, blank: float | None) -> _Grid:
        """One from which no sample is off by more; what is coded by it tells `blank` from samples."""
        values = np.flatnonzero(self._occurs)
        if not values.size:
            return _Grid(0, 1, 0, is_whole=True)
        step = int(np.gcd.reduce(values - values[0])) or 1
        most = int(values[-1] - values[0]) // step
        return _Grid(int(values[0]), step, most, min(most, int(max_error // step)), is_whole=True)


class _Floats:
    """The floats that occur in a channel, while they are few, and the scales that make whole numbers of all of them."""

    def __init__(self) -> None:
        self.low = self.high = 0.0
        self._ranks: NDArray[np.int32] | None = np.zeros(0, np.int32)
        self._scales = list(_SCALES)

    def see(self, samples: NDArray[Any]) -> None:
        """More samples of the channel."""
        if samples.size:
            is_first = self._ranks is not None and not self._ranks.size
            low, high = float(samples.min()), float(samples.max())
            self.low, self.high = (low, high) if is_first else (min(self.low, low), max(self.high, high))
        for some in (samples[:1000], samples):
            self._scales = [scale for scale in self._scales if _are_whole(some, scale)]
        if self._ranks is not None:
            ranks = np.union1d(self._ranks, _turned(samples.view(np.int32)))
            self._ranks = ranks if ranks.size <= _MAX_TABLE else None

    def distinct(self) -> NDArray[np.float64] | None:
        """All of them, rising, 0 behind −0; None where they are many."""
        return None if self._ranks is None else _turned(self._ranks).view(np.float32).astype(np.float64)

    def exact_grid(self) -> _Grid:
        """One with all samples on it, or near them."""
        reach = self.high - self.low
        scale = self._scale()
        if scale is not None:
            return _Grid(self.low, 1 / scale, round(reach * scale))
        return _Grid(self.low, reach / _native.MAX_GRID_STEPS or 1.0, _native.MAX_GRID_STEPS if reach else 0)

    def grid(self, max_error: float, blank: float | None) -> _Grid | None:
        """One from which no sample is off by more, and on which `blank` is not; None if there is no such."""
        rounded = float(np.spacing(np.float32(max(abs(self.low), abs(self.high)))))
        free, scale = 2 * (max_error - rounded), self._scale()
        if scale is not None and max_error >= rounded:
            exact = self.exact_grid()
            is_exact = scale & (scale - 1) == 0
            most_off = min(exact.most, int((max_error - (0 if is_exact else rounded)) * scale))
            if (2 * most_off + 1) / scale >= free:
                return replace(exact, max_error=most_off)
        while free > 0 and (self.high - self.low) / free < _native.MAX_GRID_STEPS:
            grid = _Grid(self.low, free, int((self.high - self.low) / free + 0.5))
            if blank is None or not _is_on(grid, blank):
                return grid
            free *= 0.999
        return None

    def _scale(self) -> int | None:
        """The least scale that makes whole numbers of all samples, not too large ones."""
        reach = self.high - self.low
        return next((scale for scale in self._scales if reach * scale <= _native.MAX_GRID_STEPS), None)


def _turned(bits: NDArray[np.int32]) -> NDArray[np.int32]:
    """The bits of floats as numbers that rise with them; the bits, if given those."""
    return np.where(bits < 0, np.int32(-1) - (bits & np.int32(0x7FFFFFFF)), bits)


def _are_whole(samples: NDArray[np.float32], scale: float) -> bool:
    wide = samples.astype(np.float64)
    return bool((np.rint(wide * scale) / scale).astype(np.float32).tobytes() == samples.tobytes())


def _is_on(grid: _Grid, sample: float) -> bool:
    value = np.clip(round((sample - grid.base) / grid.step), 0, grid.most) if np.isfinite(sample) else 0
    return bool(np.float32(grid.base + grid.step * value) == np.float32(sample))


def _with_table(channel: _Integers | _Floats, grid: _Grid | None, max_error: float) -> _Grid | None:
    """One on which values stand for samples that occur, none off by more; None where they are not fewer than steps."""
    samples, grid = channel.distinct(), grid or channel.exact_grid()
    if samples is None or len(samples) < 2:
        return None
    table = _thinned(samples, max_error)
    if len(table) * (2 * grid.max_error + 1) > grid.most:
        return None
    found = replace(grid, max_error=0, table=table.astype(np.float32))
    if not grid.is_whole:
        most = max(1, len(table) - 1)
        found = replace(
            found, base=float(table[0]), step=float(table[-1] - table[0]) / most or 1.0, most=len(table) - 1
        )
    return found


def _thinned(samples: NDArray[np.float64], max_error: float) -> NDArray[np.float64]:
    """As few of these, which rise, as leave none off by more."""
    if not max_error:
        return samples
    kept, at = [], 0
    while at < len(samples):
        kept.append(samples[np.searchsorted(samples, samples[at] + max_error, "right") - 1])
        at = int(np.searchsorted(samples, kept[-1] + max_error, "right"))
    return np.array(kept)
