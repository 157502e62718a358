"""What a step of a tile's fit will cost next to other tiles', from a quick look at some of its pixels."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from sgicodec.encoding import Encoding, empty_pixels
from sgicodec.image import Picture
from sgicodec.model.layout import adaptive_layout
from sgicodec.plan import Plan

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
    part = sampled(window)
    tile = Encoding(part, replace(plan, metadata=None), time.monotonic())
    seeds = len(adaptive_layout(tile.target, tile.fit.split * tile.fit.lmbda * tile.fit.seed_bits))
    return pixels + _SEED_PIXELS * seeds * pixels / (part.width * part.height)


def sampled(window: Picture) -> Picture:
    """A sixteenth of the pixels: four blocks side by side; all of them where there are few."""
    height, width = window.height // 8, window.width // 8
    if min(height, width) < _LEAST_SIDE:
        return window
    rows, columns = (np.r_[2 * side : 3 * side, 5 * side : 6 * side] for side in (height, width))
    return replace(window, pixels=np.ascontiguousarray(window.pixels[np.ix_(rows, columns)]))


_SEED_PIXELS = 31.0
"""Pixels that a step takes as long for as for a seed that the fit starts with: of fits of three tiles of a satellite
picture, which began with 17,000 to 25,000 seeds, by one thread.
"""
_LEAST_SIDE = 32
"""Pixels of a block: detail of one cell of the base layer of tiles."""
