"""The CPU back end: a numpy interface to the C++ kernels, which keeps their working memory between calls."""

from __future__ import annotations

import numpy as np

from sgicodec import _native
from sgicodec.arrays import F32
from sgicodec.device import ALL_CORES, PROCESSOR, Device
from sgicodec.raster.backend import DEFAULT_CUTOFF, Errors, Loss

MAX_PAIRS = 1 << 28
"""A sound picture has a few pairs per Gaussian."""


class NativeRasterizer:
    """Additive splatting on the CPU, a `Backend` of float32 numpy arrays. Same input, same bytes, whatever the number
    of threads.

    Raises ValueError for an instruction set that this processor lacks. `cutoff` is where a Gaussian ends, in standard
    deviations. A call that would list more than `most_pairs` (tile, Gaussian) pairs, 12 bytes each, raises
    OverflowError: a hostile stream must not take all memory. An instance keeps its memory
    and is not safe for use by two threads at once.
    """

    device_name = PROCESSOR

    def __init__(self, device: Device = ALL_CORES, cutoff: float = DEFAULT_CUTOFF, most_pairs: int = MAX_PAIRS) -> None:
        self._raster = _native.Rasterizer(device.isa, device.threads, most_pairs)
        self.cutoff = cutoff

    @property
    def isa(self) -> str:
        """The instruction set in use."""
        return self._raster.isa

    @property
    def tile_pairs(self) -> int:
        """(Tile, Gaussian) pairs of the last forward pass."""
        return self._raster.pairs

    def forward(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        width: int,
        height: int,
        origin: tuple[int, int] = (0, 0),
    ) -> F32:
        """Image [C, height, width] of means [N, 2], covariances [N, 3] (xx, xy, yy), colours [N, C], in pixels."""
        image = np.empty((colours.shape[1], height, width), np.float32)
        self._raster.forward(means, covariances, colours, image, *origin, self.cutoff)
        return image

    def error(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        target: F32,
        loss: Loss = "squared",
        weight: float = 1.0,
        weights: F32 | None = None,
        origin: tuple[int, int] = (0, 0),
    ) -> tuple[Errors, tuple[F32, F32, F32]]:
        """As in `Backend`, of target [C, H, W], without storing the image."""
        out = np.empty_like(means), np.empty_like(covariances), np.empty_like(colours)
        arrays = means, covariances, colours, target
        errors = self._raster.error(*arrays, *origin, self.cutoff, loss == "absolute", weight, weights, *out)
        return Errors(*errors), out
