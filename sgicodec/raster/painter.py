"""What draws decoded Gaussians on a GPU, in the place of the decoder's own rasteriser."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.cuda.gpu import Gpu, GpuArray
from sgicodec.cuda.tiles import MAX_CHANNELS
from sgicodec.raster.backend import Background, Mapping, nothing_behind
from sgicodec.raster.cuda import CudaRasterizer
from sgicodec.raster.cuda_texture import TextureTables, drawn_texture

__all__ = ["GpuPainter"]

F32 = NDArray[np.float32]

MAX_PAIRS = 1 << 26
"""The decoder's own limit, for tiles of a quarter of the size."""


class GpuPainter:
    """Gaussians, base layer, texture and samples, on a GPU that all painters of a process share: threads
    take turns. The decoder calls it (native/bindings/python_painter.cpp).
    """

    most_channels = MAX_CHANNELS

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu

    def paint(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        out: NDArray[Any],
        origin: tuple[int, int],
        cutoff: float,
        background: tuple[F32 | None, NDArray[np.int32] | None, F32 | None, F32 | None],
        texture: tuple[Any, ...] | None,
        mapping: tuple[F32, F32] | None,
    ) -> None:
        """As `Backend.draw`; of a background, None is what there is none of. Raises OverflowError for too many pairs of
        tile and Gaussian.
        """
        lines, top, down, planes = background
        if lines is None or top is None or down is None:
            behind = nothing_behind(colours.shape[1], planes)
        else:
            behind = Background(lines, top, down, planes)
        with self._gpu.turn:
            raster = CudaRasterizer(self._gpu, cutoff, MAX_PAIRS)
            drawn: GpuArray | None = None
            if texture is not None:
                self._gpu.use()
                drawn = drawn_texture(self._gpu, TextureTables(*texture), (colours.shape[1], *out.shape[:2]))
            raster.draw(means, covariances, colours, out, origin, behind, mapping and Mapping(*mapping), drawn)
