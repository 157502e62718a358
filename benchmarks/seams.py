"""Error near the edges of tiles against that elsewhere: python -m benchmarks.seams PICTURE…"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.pipeline import encode
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.image import read
from sgicodec.model.tile_grid import TileGrid
from sgicodec.picture import Picture

__all__ = ["main", "near_edges", "ratio"]

NEAR = 8
"""Pixels on each side of an edge."""


def near_edges(grid: TileGrid) -> NDArray[np.bool_]:
    """Which pixels [H, W] lie within NEAR of an edge between cores."""
    mask = np.zeros((grid.height, grid.width), np.bool_)
    for axis, view in ((grid.across, mask.T), (grid.down, mask)):
        for index in range(1, axis.count):
            edge = axis.edge(index)
            view[max(0, edge - NEAR) : edge + NEAR] = True
    return mask


def ratio(picture: Picture, data: bytes, near: NDArray[np.bool_]) -> float:
    """Root mean square error where `near`, over that elsewhere."""
    with open_stream(data) as stream:
        decoded = stream.picture(threads=1).pixels
    error = np.square(decoded.astype(np.float64) - picture.pixels).mean(axis=2)
    return float(np.sqrt(error[near].mean() / error[~near].mean()))


def main(paths: list[str]) -> None:
    """Prints a line for each picture: aprons of 4, 8 and 16 pixels, then a single tile."""
    for path in paths:
        whole = read(path)
        picture = replace(whole, pixels=np.ascontiguousarray(whole.pixels[:384, :512]))
        settings = EncodeSettings(steps=150, tile=128, threads=1)
        near = near_edges(settings.grid(picture.width, picture.height))
        tried = [replace(settings, apron=apron) for apron in (4, 8, 16)] + [replace(settings, tile=0)]
        found = [ratio(picture, encode(picture, each).data, near) for each in tried]
        print(path, *(f"{value:.3f}" for value in found))


if __name__ == "__main__":
    main(sys.argv[1:])
