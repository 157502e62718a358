"""A picture whose text and line art looks otherwise: with fewer colours, or not at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32
from sgicodec.encoder.input.nodata import inpaint
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.residual.graphic_cells import CELL, Cells, ColourCounts, cells_in, colour_keys, pixels_in_cells
from sgicodec.metadata.layouts import alpha_index
from sgicodec.model.tile_grid import Rect
from sgicodec.picture import Picture

_MEANT_COLOURS = 64
"""With no more colours than these each is meant, as the classes of a map; shades of soft edges are more."""


def with_fewer_colours(windows: Windows, cells: Cells, counts: ColourCounts, max_error: int) -> tuple[Windows, int]:
    """A picture whose samples in these cells [rows, columns] are off by `max_error` at most, so that there are fewer
    colours, and by how much they are. Colours whose pixels lie elsewhere than at edges stay: grounds, gradients. So
    do all where they are few, as the classes of a map.
    """
    channels = windows.shape.bands
    colours = np.stack([counts.keys >> 16 * (channels - 1 - c) & 0xFFFF for c in range(channels)], axis=1)
    shown = _merged(colours, counts, max_error if len(colours) > _MEANT_COLOURS else 0)
    off = int(np.abs(shown - colours).max(initial=0))
    return (_replaced(windows, cells, partial(_recoloured, counts.keys, shown)) if off else windows), off


def without_cells(windows: Windows, cells: Cells, means: F32) -> Windows:
    """A picture whose cells [rows, columns] are filled smoothly from what is around them. means [rows, columns, C]: of
    the samples of each cell.
    """
    return _replaced(
        windows, cells, partial(_interpolated, inpaint(means.transpose(2, 0, 1), cells).transpose(1, 2, 0))
    )


def without_unseen_colours(windows: Windows) -> Windows:
    """A picture whose colours are 0 wherever its alpha is; itself without alpha."""
    if alpha_index(windows.shape.channels) is None:
        return windows
    return windows.seen(
        lambda picture, _: replace(picture, pixels=np.where(picture.pixels[..., -1:] == 0, 0, picture.pixels))
    )


def _merged(colours: NDArray[np.int64], counts: ColourCounts, max_error: int) -> NDArray[np.int64]:
    """What is shown instead of each colour [n, C]: the most frequent one that no sample is further from, beginning with
    the most frequent.
    """
    shown, left = colours.copy(), np.argsort(-counts.pixels, kind="stable")
    is_soft = 2 * counts.at_edges < counts.pixels
    while left.size and max_error:
        near = np.abs(colours[left] - colours[left[0]]).max(axis=1) <= max_error
        near[1:] &= ~is_soft[left[1:]]
        shown[left[near]] = colours[left[0]]
        left = left[~near]
    return shown


def _replaced(windows: Windows, cells: Cells, shown: Callable[[NDArray[Any], Cells, Rect], NDArray[Any]]) -> Windows:
    """A picture that shows something else in some cells: shown(pixels, inside, rect) gives the samples [n, C] of the
    pixels of a window that are inside.
    """

    def look(picture: Picture, rect: Rect) -> Picture:
        inside = pixels_in_cells(cells[cells_in(rect)], picture.pixels.shape, rect[0] % CELL, rect[1] % CELL)
        if not inside.any():
            return picture
        pixels = picture.pixels.copy()
        pixels[inside] = shown(pixels, inside, rect)
        return replace(picture, pixels=pixels)

    return windows.seen(look)


def _recoloured(
    keys: NDArray[np.int64], shown: NDArray[np.int64], pixels: NDArray[Any], inside: Cells, rect: Rect
) -> NDArray[Any]:
    """Of colours `keys`, ascending [n], those that are shown instead [n, C]; others as they are."""
    given = pixels[inside]
    wanted = colour_keys(given)
    places = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where((keys[places] == wanted)[:, None], shown[places], given)


def _interpolated(means: F32, pixels: NDArray[Any], inside: Cells, rect: Rect) -> NDArray[Any]:
    """What lies between means of cells [rows, columns, C]."""
    y, x = np.nonzero(inside)
    found = np.zeros((len(y), pixels.shape[2]), np.float32)
    top, bottom, low = _between(rect[1] + y, means.shape[0])
    left, right, far = _between(rect[0] + x, means.shape[1])
    for row, down in ((top, 1 - low), (bottom, low)):
        for column, across in ((left, 1 - far), (right, far)):
            found += means[row, column] * (down * across)[:, None]
    return np.rint(found)


def _between(places: NDArray[np.int_], count: int) -> tuple[NDArray[np.int_], NDArray[np.int_], F32]:
    """The two of `count` cells between whose middles places along an axis lie, and how near to the second."""
    at = np.clip((places + 0.5) / CELL - 0.5, 0, count - 1)
    first = at.astype(np.int_)
    return first, np.minimum(first + 1, count - 1), (at - first).astype(np.float32)
