"""Which cells of a picture show text, line art or flat ground: few colours that repeat each other, and hard edges."""

from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.header import Header
from sgicodec.metadata.layouts import band_ranges
from sgicodec.model.tile_grid import Rect

CELL = _native.RESIDUAL_CELL
"""Pixels of a side."""

Cells = NDArray[np.bool_]

_NOVEL = 0.45
"""Text has fewer pixels in any cell that are neither as the one to their left nor as the one above; of 17 photographs
and scans, 14 have as few in less than 5 % of their cells (docs/notes/2026-11-text.md)."""
_NOVEL_INSIDE, _SIDES_INSIDE = 0.8, 3
"""The same of a cell that has such cells at so many of its sides."""
_EDGE, _WEAK = 24, 6
"""Levels of 255 from a neighbour: from which on they are an edge, and up to which they are noise or a gradient."""
_MAX_WEAK = 0.1
"""Share of a cell's pixels that are weak, in text."""
_MIN_EDGES = 0.5
"""Share of an area's novel pixels that are edges, in text."""
_SHARP = 8
"""Edges in a cell, from which on it is sharp."""
_MIN_CELLS, _MIN_SHARP = 16, 4
"""Cells of an area of text, and those of them that are sharp."""
_FEW_COLOURS = 32
"""The most frequent ones of an area; a cell of others has no faint edges that are drawn on purpose."""
_MIN_GROUND = 0.4
"""Share of such an area's pixels that have the usual colour."""
_MIN_CONTRAST = 8
"""Levels of 255 from the usual colour at which ink begins."""
_MIN_INK = 0.1
"""Share of pixels of other colours that are ink."""
_MIN_FAINT = 0.5
"""Share of the cells of an area of the picture that have such faint edges."""


class CellCounts(NamedTuple):
    """Of each cell [rows, columns]: pixels that are novel, those of them that are edges, and those that are weak."""

    novel: NDArray[np.int_]
    edges: NDArray[np.int_]
    weak: NDArray[np.int_]


class CellSurvey:
    """What is known of the cells of a picture, block by block."""

    def __init__(self, header: Header) -> None:
        self._level = level_of(header)
        shape = cells_shape(header.width, header.height)
        self._counts = CellCounts(*np.zeros((3, *shape), np.int_))
        self._faint: Cells = np.zeros(shape, np.bool_)

    def see(self, rect: Rect, pixels: NDArray[Any]) -> None:
        """A block of the picture, whose corners are those of cells."""
        at = cells_in(rect)
        counts = _counted(pixels, self._level)
        for known, found in zip(self._counts, counts, strict=True):
            known[at] = found
        self._faint[at] = _drawn_in_few_colours(pixels, _repeat(counts.novel), self._level)

    def graphic(self) -> Cells:
        """Which cells are."""
        novel, edges, weak = self._counts
        found = _repeat(novel) & ((weak <= _MAX_WEAK * CELL * CELL) | self._faint)
        found |= (novel < _NOVEL_INSIDE * CELL * CELL) & (_sides(found) >= _SIDES_INSIDE)
        areas = _areas(found)
        size, of_novel, of_edges, sharp, faint = (
            np.bincount(areas.ravel(), weights.ravel(), minlength=found.size + 1)
            for weights in (found, novel, edges, edges >= _SHARP, self._faint)
        )
        is_kept = (of_edges >= _MIN_EDGES * of_novel) & (sharp >= _MIN_SHARP) | (faint >= _MIN_FAINT * size)
        is_kept &= size >= _MIN_CELLS
        kept: Cells = found & is_kept[areas]
        return kept

    def edges(self, cells: Cells) -> int:
        """Pixels of these cells that a lossy picture spends bits on: edges; all novel ones where colours are few."""
        counted = np.where(self._faint, self._counts.novel, self._counts.edges)
        return int(counted[cells].sum())


def level_of(header: Header) -> float:
    """A 255th of the narrowest range of a channel."""
    return min(high - low for low, high in band_ranges(header.sample_range, header.colours)) / 255


def cells_shape(width: int, height: int) -> tuple[int, int]:
    """Rows and columns of cells of so many pixels."""
    return -(-height // CELL), -(-width // CELL)


def cells_in(rect: Rect) -> tuple[slice, slice]:
    """Where the cells that touch a region lie, in rows and columns of them."""
    x, y, width, height = rect
    rows, columns = cells_shape(x + width, y + height)
    return slice(y // CELL, rows), slice(x // CELL, columns)


def stacked_cells(pixels: NDArray[Any], cells: Cells) -> NDArray[Any]:
    """Pixels [n · CELL, CELL, C] of those cells of a block that are true."""
    return _blocked(pixels).swapaxes(1, 2)[cells].reshape(-1, CELL, pixels.shape[2])


def cell_means(pixels: NDArray[Any]) -> NDArray[np.float32]:
    """Means [rows, columns, C] of the cells of a block."""
    means: NDArray[np.float32] = _blocked(pixels.astype(np.float32)).mean(axis=(1, 3))
    return means


def pixels_in_cells(cells: Cells, shape: tuple[int, ...], left: int = 0, top: int = 0) -> Cells:
    """Which pixels [h, w] of a region lie in these cells: the first pixel is at (left, top) of the first cell."""
    down, across = (np.arange(start, start + side) // CELL for start, side in ((top, shape[0]), (left, shape[1])))
    return cells[down[:, None], across]


def colour_keys(pixels: NDArray[Any]) -> NDArray[np.int64]:
    """A number for each colour of pixels [..., C], C <= 4, of whole numbers below 2^16."""
    keys = np.zeros(pixels.shape[:-1], np.int64)
    for channel in range(pixels.shape[-1]):
        keys = keys << 16 | pixels[..., channel].astype(np.int64)
    return keys


class ColourCounts(NamedTuple):
    """Colours by `colour_keys`, ascending [n], how many pixels have each, and how many of them lie at an edge."""

    keys: NDArray[np.int64]
    pixels: NDArray[np.int64]
    at_edges: NDArray[np.int64]


class ColourSurvey:
    """The colours of cells of a picture, block by block."""

    def __init__(self, header: Header) -> None:
        self._least = _EDGE * level_of(header)
        self._pixels: Counter[int] = Counter()
        self._at_edges: Counter[int] = Counter()

    def see(self, pixels: NDArray[Any], cells: Cells) -> None:
        """A block [h, w, C] and those of its cells [rows, columns] that count."""
        if not cells.any():
            return
        inside = pixels_in_cells(cells, pixels.shape)
        keys = colour_keys(pixels[inside])
        at_edges = keys[_beside_edges(pixels, self._least)[inside]]
        for counter, some in ((self._pixels, keys), (self._at_edges, at_edges)):
            found, times = np.unique(some, return_counts=True)
            counter.update(dict(zip(found.tolist(), times.tolist(), strict=True)))

    @property
    def counts(self) -> ColourCounts:
        """How often each was seen."""
        known = sorted(self._pixels)
        seen = ([counter[key] for key in known] for counter in (self._pixels, self._at_edges))
        return ColourCounts(*(np.array(some, np.int64) for some in (known, *seen)))


def repeating_cells(pixels: NDArray[Any]) -> Cells:
    """Which cells of a block have as few novel pixels as text: a quick look."""
    across, down = _steps(pixels)
    return _repeat(_in_cells((across > 0) & (down > 0)))


def _repeat(novel: NDArray[np.int_]) -> Cells:
    """Which cells with so many novel pixels have as few as text."""
    found: Cells = novel < _NOVEL * CELL * CELL
    return found


def _drawn_in_few_colours(pixels: NDArray[Any], cells: Cells, level: float) -> Cells:
    """Which of these cells of a block lie in areas of few colours: a ground, an ink, and what lies between them."""
    found: Cells = np.zeros_like(cells)
    for area in _large_areas(cells):
        for part in _large_areas(_of_few_colours(pixels, area)):
            inside = pixels[pixels_in_cells(part, pixels.shape)]
            _, first, times = np.unique(colour_keys(inside), return_index=True, return_counts=True)
            colours = inside[first].astype(np.float64)
            far = np.abs(colours - colours[times.argmax()]).max(axis=1) / level
            ground, ink = times.max(), times[far >= _MIN_CONTRAST].sum()
            found |= part & (ground >= _MIN_GROUND * times.sum() and ink > _MIN_INK * times[far > 0].sum())
    return found


def _of_few_colours(pixels: NDArray[Any], area: Cells) -> Cells:
    """The cells of an area that have its most frequent colours alone: calm places of a photograph may touch text."""
    inside = pixels_in_cells(area, pixels.shape)
    _, number, times = np.unique(colour_keys(pixels[inside]), return_inverse=True, return_counts=True)
    is_rare = np.ones(len(times), np.bool_)
    is_rare[np.argsort(times)[-_FEW_COLOURS:]] = False
    rare = np.zeros(pixels.shape[:2], np.bool_)
    rare[inside] = is_rare[number]
    frequent: Cells = area & (_in_cells(rare) == 0)
    return frequent


def _large_areas(cells: Cells) -> list[Cells]:
    """Areas of these cells, each as cells, that are no specks."""
    areas = _areas(cells)
    large = np.flatnonzero(np.bincount(areas.ravel())[1:] >= _MIN_CELLS) + 1
    return [areas == number for number in large]


def _steps(pixels: NDArray[Any]) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """How far each pixel [h, w, C] is from the one to its left, and from the one above: in its furthest channel."""
    wide = np.int16 if pixels.dtype == np.uint8 else np.int32
    across, down = (np.zeros(pixels.shape[:2], wide) for _ in range(2))
    for channel in range(pixels.shape[2]):
        plane = pixels[..., channel].astype(wide)
        np.maximum(across[:, 1:], np.abs(np.diff(plane, axis=1)), out=across[:, 1:])
        np.maximum(down[1:], np.abs(np.diff(plane, axis=0)), out=down[1:])
    return across, down


def _beside_edges(pixels: NDArray[Any], least: float) -> Cells:
    """Which pixels differ by so much from one of the four beside them."""
    across, down = (steps >= least for steps in _steps(pixels))
    found = across | down
    found[:, :-1] |= across[:, 1:]
    found[:-1] |= down[1:]
    return found


def _counted(pixels: NDArray[Any], level: float) -> CellCounts:
    """Counts of the cells of a block."""
    across, down = _steps(pixels)
    is_novel = (across > 0) & (down > 0)
    is_edge = is_novel & (np.maximum(across, down) >= _EDGE * level)
    is_weak = is_novel & (np.minimum(across, down) <= _WEAK * level)
    return CellCounts(*map(_in_cells, (is_novel, is_edge, is_weak)))


def _in_cells(pixels: Cells) -> NDArray[np.int_]:
    """How many pixels of each cell are true."""
    counts: NDArray[np.int_] = _blocked(pixels[..., None]).sum(axis=(1, 3, 4))
    return counts


def _blocked(pixels: NDArray[Any]) -> NDArray[Any]:
    """Pixels [h, w, C] as [rows, CELL, columns, CELL, C] of cells; beyond the ends the last ones are repeated."""
    height, width, channels = pixels.shape
    pad = ((0, -height % CELL), (0, -width % CELL), (0, 0))
    full = np.pad(pixels, pad, mode="edge") if any(after for _, after in pad) else pixels
    return full.reshape(full.shape[0] // CELL, CELL, full.shape[1] // CELL, CELL, channels)


def _sides(cells: Cells) -> NDArray[np.int_]:
    """How many of the four sides of each cell lie at one of `cells` or at the end of the picture."""
    known = np.pad(cells, 1, constant_values=True).astype(np.int_)
    return known[:-2, 1:-1] + known[2:, 1:-1] + known[1:-1, :-2] + known[1:-1, 2:]


def _areas(cells: Cells) -> NDArray[np.int_]:
    """A number for each cell, the same in all that touch each other along a side; 0 for what is not in `cells`."""
    labels = np.where(cells, np.arange(1, cells.size + 1).reshape(cells.shape), 0)
    parents = np.arange(cells.size + 1)
    while True:
        least = labels.copy()
        for one, other in (
            ((slice(1, None),), (slice(-1),)),
            ((slice(None), slice(1, None)), (slice(None), slice(-1))),
        ):
            both = cells[one] & cells[other]
            for to, source in ((one, other), (other, one)):
                least[to] = np.where(both, np.minimum(least[to], labels[source]), least[to])
        if np.array_equal(least, labels):
            return labels
        np.minimum.at(parents, labels.ravel(), least.ravel())
        while not np.array_equal(parents, jumped := parents[parents]):
            parents = jumped
        labels = parents[least]
