"""The weight of a tile in the time budget: the estimated cost of a step of its fit, from some of its pixels."""

from __future__ import annotations

from dataclasses import replace

from sgicodec.encoder.input.nodata import empty_pixels
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile.inputs import tile_of
from sgicodec.encoder.tile.stages import prepare
from sgicodec.model.layout import adaptive_layout
from sgicodec.picture import Picture

__all__ = ["sampled", "tile_weight"]


def tile_weight(window: Picture, plan: Plan) -> float:
    """In pixels: those that the tile covers, and what its seeds cost beside; 1 where no pixel holds anything.

    Equal steps for all tiles, not equal times, are what makes the most of the time: a step costs more where there is
    more detail, and gains as much more.
    """
    masked = plan.header.masked
    if masked is not None and empty_pixels(window, masked).all():
        return 1.0
    pixels = window.width * window.height
    if plan.header.spec.layout == "uniform":
        return float(pixels)
    seeds = looked = 0
    for part in sampled(window):
        tile = tile_of(part, plan)
        prepared = prepare(tile, tile.fit.lmbda)
        price = prepared.fit.split_price * prepared.fit.lmbda
        seeds += len(adaptive_layout(prepared.target, price, weights=tile.reference.weights))
        looked += part.width * part.height
    return pixels + _SEED_PIXELS * seeds * pixels / looked


def sampled(window: Picture) -> list[Picture]:
    """Four blocks, a sixteenth of the pixels; all of them where there are few."""
    height, width = window.height // 8, window.width // 8
    if min(height, width) < _MIN_SIDE:
        return [window]
    corners = [(row * height, column * width) for row in (2, 5) for column in (2, 5)]
    return [replace(window, pixels=window.pixels[y : y + height, x : x + width]) for y, x in corners]


_SEED_PIXELS = 31.0
"""Pixels that a step takes as long for as for a seed that the fit starts with: of fits of three tiles of a satellite
picture, which began with 17,000 to 25,000 seeds, by one thread.
"""
_MIN_SIDE = 32
"""Pixels of a block: a cell of the base layer."""
