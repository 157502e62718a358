"""The texture layer: windowed cosines in the cells of a quadtree, a continuous function beside base and Gaussians."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import TEXTURE_MIN_LOG as MIN_LOG
from sgicodec._native import TEXTURE_ROOT_LOG as ROOT_LOG
from sgicodec._native import draw_texture
from sgicodec.device import ONE_THREAD, Device

__all__ = ["MIN_LOG", "ROOT_LOG", "TextureLayer"]

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class TextureLayer:
    """The cells of a tile that hold texture, in Z-order of the quadtree, superblock after superblock.

    size: width and height of the tile. corner [N, 2] pixels, log_size [N] of the side n; amplitudes: [C, n, n] of each
    cell (vertical frequency, then horizontal), one cell after the other. waves [N, C, 2]: rows, a multiple of four, and
    columns of amplitudes behind which all are zero.
    """

    size: tuple[int, int]
    channels: int
    corner: NDArray[np.int32]
    log_size: NDArray[np.uint8]
    amplitudes: F32
    waves: NDArray[np.uint8]

    def draw(self, device: Device = ONE_THREAD) -> F32:
        """Planes [C, h, w] of the tile."""
        width, height = self.size
        planes = np.empty((self.channels, height, width), np.float32)
        draw_texture(self.corner, self.log_size, self.amplitudes, self.waves, device.threads, device.isa, planes)
        return planes
