"""Masked pixels: what the decoder stores in them, and in pixels that must not look like them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.decoder.tile_renderer import TileRenderer
from sgicodec.decoder.view import View
from sgicodec.picture import alpha_index, equal_samples

__all__ = ["mark_nodata", "store_nodata"]

_MASK_PIXELS = 1 << 20
"""Of a mask that are expanded at a time."""


def mark_nodata(header: Header, tile: TileRenderer, view: View, at: tuple[int, int], block: NDArray[Any]) -> None:
    """Stores nothing in those pixels of block [h, w, C] whose centres the tile's mask says to hold nothing.

    block begins at output pixel `at` (x, y) of the view. Alpha becomes 0, or colours the nodata value; other
    pixels that have that value by chance go one step aside.
    """
    columns = _pixels(view.x - tile.x, view.sx, at[0], block.shape[1], tile.header.width)
    rows = _pixels(view.y - tile.y, view.sy, at[1], len(block), tile.header.height)
    each = max(1, _MASK_PIXELS // len(columns))
    for top in range(0, len(rows), each):
        band = block[top : top + each]
        empty = None if tile.mask is None else tile.mask.at(rows[top : top + each], columns)
        empty = np.zeros(band.shape[:2], np.bool_) if empty is None else empty
        if header.masked == "transparent":
            band[empty, -1] = 0
        else:
            store_nodata(header, band[..., : alpha_index(header.channels)], empty)


def store_nodata(header: Header, colours: NDArray[Any], empty: NDArray[np.bool_]) -> None:
    """Stores nodata in the empty pixels [h, w] of colours [h, w, C]; others that have its value go one step aside."""
    alike = ~empty & equal_samples(colours, header.nodata).all(axis=-1)
    colours[alike, 0] = _beside(header, colours.dtype)
    colours[empty] = header.nodata


def _pixels(start: float, scale: float, first: int, count: int, size: int) -> NDArray[np.int64]:
    """The tile's pixels that hold the centres of `count` output pixels."""
    at = np.floor(start + (first + np.arange(count) + 0.5) / scale)
    return np.asarray(np.clip(at, 0, size - 1), np.int64)


def _beside(header: Header, dtype: np.dtype[Any]) -> Any:
    """The sample next to the nodata value, towards the middle of the range."""
    low, high = header.sample_range
    if dtype.kind == "f":
        return np.nextafter(dtype.type(header.nodata), dtype.type((low + high) / 2))
    return dtype.type(header.nodata + (1 if header.nodata < (low + high) / 2 else -1))
