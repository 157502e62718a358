"""The compositor: tiles become a view, with a cross-fade where they overlap."""

from __future__ import annotations

from itertools import chain, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.decoder.dither import dithered
from sgicodec.decoder.nodata import mark_nodata
from sgicodec.decoder.tile_cache import TileCache
from sgicodec.decoder.tile_renderer import TileRenderer
from sgicodec.decoder.view import View
from sgicodec.device import Device
from sgicodec.model.tile_grid import Segment
from sgicodec.picture import alpha_index, full_range
from sgicodec.raster import Mapping

__all__ = ["render_view", "sample_mapping"]

F32 = NDArray[np.float32]


def render_view(
    header: Header,
    tiles: TileCache,
    view: View,
    out: NDArray[Any],
    mapping: Mapping | None,
    device: Device,
    top: int = 0,
    dither: bool = False,
) -> None:
    """Fills out [rows, columns, C] with the view from its row `top` on.

    mapping: how values become samples of out's type, None for floats as they are; dither: not to the nearest.
    """
    grid = header.grid
    segments = list(
        product(
            grid.down.segments(view.y, view.sy, top, len(out)), grid.across.segments(view.x, view.sx, 0, view.columns)
        )
    )
    meeting = [
        [grid.number(column, row) for row in _both(down) for column in _both(across)] for down, across in segments
    ]
    with tiles.prefetch(dict.fromkeys(chain.from_iterable(meeting)), view):
        for (down, across), numbers in zip(segments, meeting, strict=True):
            block = out[down.first : down.last, across.first : across.last]
            at = across.first, top + down.first
            here = [tiles.tile(number) for number in numbers]
            drawn, how = (np.empty(block.shape, np.float32), None) if dither else (block, mapping)
            if len(here) == 1:
                here[0].draw(view, at, drawn, how, device)
            else:
                _blend(here, (down, across), view, at, drawn, how, device)
            if dither and mapping is not None:
                block[...] = dithered(drawn, mapping, at, alpha_index(header.channels), block.dtype)
            if mapping is not None and header.masked is not None:
                mark_nodata(header, here[0], view, at, block)


def sample_mapping(header: Header) -> Mapping:
    """How values become samples: colours span the stated range, alpha its type."""
    low, high = (np.full(header.spec.channels, value, np.float64) for value in header.sample_range)
    alpha = alpha_index(header.channels)
    if alpha is not None:
        low[alpha], high[alpha] = full_range(header.sample_type)
    return Mapping(low.astype(np.float32), (high - low).astype(np.float32))


def _both(segment: Segment) -> tuple[int, ...]:
    return (segment.tile,) if segment.weight is None else (segment.tile, segment.tile + 1)


def _blend(
    tiles: list[TileRenderer],
    where: tuple[Segment, Segment],
    view: View,
    at: tuple[int, int],
    block: NDArray[Any],
    mapping: Mapping | None,
    device: Device,
) -> None:
    """Draws what two or four tiles share: each fades into the next."""
    down, across = (_shares(segment) for segment in where)
    total = np.zeros(block.shape, np.float32)
    drawn = np.empty(block.shape, np.float32)
    weights = [(w_down, w_across) for w_down in down for w_across in across]
    for tile, (w_down, w_across) in zip(tiles, weights, strict=True):
        tile.draw(view, at, drawn, None, device)
        total += drawn * (w_down[:, None, None] * w_across[None, :, None])
    block[...] = total if mapping is None else mapping.samples(total, block.dtype)


def _shares(segment: Segment) -> list[F32]:
    if segment.weight is None:
        return [np.ones(segment.last - segment.first, np.float32)]
    return [1 - segment.weight, segment.weight]
