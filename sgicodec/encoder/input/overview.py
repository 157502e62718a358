"""The small picture that a stream of many pixels carries, so that small views cost what they show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32, F64
from sgicodec.decoder.view import overview_size
from sgicodec.encoder.input.nodata import store_nodata
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.metadata.layouts import alpha_index
from sgicodec.model.tile_grid import Rect
from sgicodec.picture import Picture, exact_samples, from_unit, nodata_mask, nodata_samples, to_unit
from sgicodec.profiles.default import lmbda_of_quality
from sgicodec.rate_control.quality_search import QUALITY_PER_OCTAVE

_MIN_PIXELS = 1 << 20
"""Of a picture that has an overview where nothing else is asked for: smaller ones are rendered in no time."""

_FINER = 2 ** (15 / QUALITY_PER_OCTAVE)
"""The picture's λ over that of its overview: 15 steps of quality, about 1 % of the stream
(docs/notes/2026-11-large-pictures.md)."""

_ROWS = 128
"""Of a window that are averaged at a time."""


def takes_overview(plan: Plan) -> bool:
    """Whether the stream of this plan is to have an overview."""
    header, settings = plan.header, plan.settings
    if settings.profile == "paper" or header.grid.count == 1:
        return False
    return header.width * header.height >= _MIN_PIXELS if settings.overview is None else settings.overview


def overview_settings(plan: Plan, lmbda: float) -> EncodeSettings:
    """Those of the overview of a stream whose tiles are fitted at λ."""
    tiles = {"tile": plan.header.tile, "apron": plan.header.apron, "overview": False}
    if plan.settings.max_error is not None:  # below which there may be next to nothing
        lmbda = min(lmbda, lmbda_of_quality(plan.settings.chosen_quality))
    return plan.settings.without_target(
        lmbda=lmbda / _FINER, metadata=False, max_error=None, network=None, prior=None, **tiles
    )


def overview_picture(plan: Plan, read: Callable[[int, int, int, int], Picture]) -> Picture:
    """The picture in small: the mean of all pixels that each of its own covers, colours weighed by alpha.

    read: gives the picture of a window (x, y, width, height); it is asked for windows of a tile's size from the top
    down. A sample at whose centre nothing was measured holds nothing; where nodata is around, what was measured counts.
    """
    header, grid = plan.header, plan.header.grid
    columns, rows = overview_size(header.width, header.height)
    down, across = _Boxes(header.height, rows), _Boxes(header.width, columns)
    pixels = np.empty((rows, columns, header.spec.channels), header.sample_type)
    band = _Band(0, np.zeros((0, columns, 2 * header.spec.channels)), np.zeros((0, columns, header.colours), np.bool_))
    for row in range(grid.down.count):
        bottom = grid.down.edge(row + 1)
        band = band.until(down.behind(bottom))
        for column in range(grid.across.count):
            core = grid.core(grid.number(column, row))
            band.add(read(*core), core, down, across)
        done = down.whole(bottom) - band.first
        pixels[band.first : band.first + done] = _samples(plan, band.total[:done], band.nothing[:done])
        band = _Band(band.first + done, band.total[done:], band.nothing[done:])
    return Picture(pixels, header.channels, header.sample_range, blank=header.blank)


class _Band(NamedTuple):
    """Rows of the overview from `first` on that are not finished: sums of weighed samples, and of weights
    [rows, columns, 2 C]; where the sample at the centre holds nothing [rows, columns, colours].
    """

    first: int
    total: F64
    nothing: NDArray[np.bool_]

    def until(self, behind: int) -> _Band:
        """The same with room for the rows before `behind`."""
        more = behind - self.first - len(self.total)
        total = np.concatenate([self.total, np.zeros((more, *self.total.shape[1:]))])
        nothing = np.concatenate([self.nothing, np.zeros((more, *self.nothing.shape[1:]), np.bool_)])
        return _Band(self.first, total, nothing)

    def add(self, window: Picture, rect: Rect, down: _Boxes, across: _Boxes) -> None:
        """Counts the pixels of a window."""
        x, top, width, height = rect
        column, of_columns = across.shares(x, width)
        for first in range(0, height, _ROWS):
            part = replace(window, pixels=window.pixels[first : first + _ROWS])
            weighed, rows = _weighed(part), len(part.pixels)
            row, of_rows = down.shares(top + first, rows)
            sums = of_columns @ (of_rows @ weighed.reshape(rows, -1)).reshape(-1, *weighed.shape[1:])
            self.total[row - self.first :, column:][: len(of_rows), : len(of_columns)] += sums
            if window.nodata is not None:
                (above, i), (left, j) = down.centres(top + first, rows), across.centres(x, width)
                self.nothing[np.ix_(above - self.first, left)] = nodata_samples(part)[np.ix_(i, j)]


def _samples(plan: Plan, total: F64, nothing: NDArray[np.bool_]) -> NDArray[Any]:
    """Means of what was summed up, as samples of the picture's type."""
    header, alpha = plan.header, alpha_index(plan.header.channels)
    samples, weights = np.split(total, 2, axis=-1)
    unit = samples / np.maximum(weights, _TINY)
    pixels = from_unit(unit, header.channels, header.sample_type, header.sample_range).pixels
    if header.masked == "nodata":
        store_nodata(header, pixels[..., :alpha], nothing)
    return pixels


_TINY = 1e-12


def _weighed(part: Picture) -> F32:
    """Samples in 0..1 times their weights, then these [h, w, 2 C]: of colours alpha, 0 where they do not follow their
    neighbours.
    """
    unit, alpha = to_unit(part), part.alpha
    weights = np.ones_like(unit)
    if alpha is not None:
        weights[..., :alpha] = unit[..., alpha:]
        weights[..., alpha] = ~nodata_mask(part)
    if part.nodata is not None or part.exact:
        weights[..., :alpha][nodata_samples(part) | exact_samples(part)] = 0
    return np.concatenate([unit * weights, weights], axis=-1)


@dataclass(frozen=True)
class _Boxes:
    """`count` boxes of equal width that cover `length` pixels along an axis."""

    length: int
    count: int

    def whole(self, stop: int) -> int:
        """How many boxes end at pixel `stop` or before it."""
        return stop * self.count // self.length

    def behind(self, stop: int) -> int:
        """How many boxes begin before pixel `stop`."""
        return -(-stop * self.count // self.length)

    def shares(self, start: int, size: int) -> tuple[int, F32]:
        """The first box that `size` pixels from `start` on touch, and how much of each pixel each box covers
        [boxes, size].
        """
        first, behind = self.whole(start), self.behind(start + size)
        edges = np.arange(first, behind + 1) * (self.length / self.count) - start
        pixel = np.arange(size)
        right, left = (np.clip(edges[part, None] - pixel, 0, 1) for part in (np.s_[1:], np.s_[:-1]))
        return first, (right - left).astype(np.float32)

    def centres(self, start: int, size: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The boxes whose centres lie in `size` pixels from `start` on, and which of these that is."""
        pixel = np.floor((np.arange(self.count) + 0.5) * (self.length / self.count)).astype(np.int64) - start
        box = np.flatnonzero((pixel >= 0) & (pixel < size))
        return box, pixel[box]
