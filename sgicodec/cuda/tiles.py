"""The rasteriser's kernels in their order: Gaussians to pairs sorted by tile, then a pass over the tiles."""

from __future__ import annotations

import ctypes
from typing import Any, NamedTuple

import numpy as np

from sgicodec.cuda import sources
from sgicodec.cuda.gpu import Gpu, GpuArray
from sgicodec.cuda.scan import Scan
from sgicodec.cuda.structures import structures

MAX_CHANNELS = 4
"""The kernels are compiled for 1 to 4 channels."""

_SIZES = {**sources.constants("cuda/raster/tiling.hpp"), **sources.constants("cuda/raster/binning.hpp")}
_SIZES |= sources.constants("cuda/raster/tile_memory.hpp")
TILE_WIDTH, TILE_HEIGHT = _SIZES["kTileColumns"], _SIZES["kTileRows"]
MOMENTS, DIGIT_BITS = _SIZES["kPairMoments"], _SIZES["kDigitBits"]
_SORT_THREADS, _TILE_THREADS = _SIZES["kSortThreads"], _SIZES["kTileThreads"]
_SORTED = _SORT_THREADS * _SIZES["kSortItems"]
SPLAT_BYTES = 13 * 4  # TileSplat
MAX_PAIRS = 1 << 28
_THREADS, _SEARCHERS = 128, 256  # of kernels with a thread for each Gaussian; of `find_tiles`


class CudaView(NamedTuple):
    """A crop of the plane, pixels."""

    width: int
    height: int
    x0: int = 0
    y0: int = 0

    @property
    def tiles(self) -> int:
        """How many tiles it touches."""
        across = (self.x0 + self.width - 1) // TILE_WIDTH - self.x0 // TILE_WIDTH + 1
        down = (self.y0 + self.height - 1) // TILE_HEIGHT - self.y0 // TILE_HEIGHT + 1
        return across * down


class TilePasses:
    """Launches of one view of `gaussians` Gaussians with `channels` channels, and the memory that they need. `fields`
    are those of RasterArguments that the caller sets: addresses, cutoff. Only passes that differentiate need room for
    what pairs add to gradients.
    """

    def __init__(
        self,
        gpu: Gpu,
        view: CudaView,
        gaussians: int,
        channels: int,
        fields: dict[str, Any],
        differentiates: bool = True,
        most_pairs: int = MAX_PAIRS,
    ) -> None:
        self.gpu, self.view, self.channels, self.gaussians = gpu, view, channels, gaussians
        self._moments, self._most_pairs = MOMENTS + channels if differentiates else 0, most_pairs
        self.splats = gpu.array(max(1, gaussians) * SPLAT_BYTES, np.uint8)
        self.slot_start = gpu.array(gaussians + 1, np.int32)
        self.tile_start = gpu.array(view.tiles + 1, np.int32)
        self.errors = gpu.array((view.tiles, 2), np.float64)
        own = {"gaussians": gaussians, **view._asdict()}
        own |= {name: getattr(self, name).address for name in ("splats", "slot_start", "tile_start", "errors")}
        self._fields = {"weight": 1.0} | fields | own
        self._starts = Scan(gpu, self.slot_start, gaussians)
        self._make_room(4 * gaussians + 4 * view.tiles)

    def _make_room(self, capacity: int) -> None:
        self.capacity, self.sort_blocks = capacity, -(-capacity // _SORTED)
        self.owner = self.gpu.array(capacity, np.int32)
        self.pairs = [self.gpu.array(capacity, np.uint32) for _ in range(4)]
        self.digits = self.gpu.array((1 << DIGIT_BITS) * self.sort_blocks + 1, np.int32)
        self.partials = self.gpu.array((capacity, self._moments))
        names = ("owner", "digits", "partials")
        self._fields |= {"capacity": capacity, "sort_blocks": self.sort_blocks}
        self._fields |= {name: getattr(self, name).address for name in names}
        self._digits = Scan(self.gpu, self.digits, self.digits.shape[0] - 1)

    def _had_room(self, pairs: int) -> bool:
        """Whether there was room for so many pairs; if not, there is from now on. Raises OverflowError for too many."""
        if pairs > self._most_pairs:
            raise OverflowError("too many Gaussians in too many tiles: draw smaller crops")
        if pairs > self.capacity:
            self._make_room(pairs + pairs // 4)
            return False
        return True

    def bin_all(self) -> None:
        """`bin`, again with more room where there was not enough."""
        self.bin()
        while not self._had_room(int(self.slot_start.last())):
            self.bin()

    def bin(self) -> None:
        """Finds the pairs and sorts them by tile, as many as there is room for."""
        blocks = -(-self.gaussians // _THREADS)
        given = self._arguments(*self.pairs)
        self.gpu.launch("prepare_splats", blocks, _THREADS, given)
        self._starts.launch()
        self.gpu.launch("list_pairs", blocks, _THREADS, given)
        now, then = self.pairs[:2], self.pairs[2:]
        for shift in range(0, max(1, (self.view.tiles - 1).bit_length()), DIGIT_BITS):
            given = self._arguments(*now, *then, shift)
            self.gpu.launch("sort_count", self.sort_blocks, _SORT_THREADS, given)
            self._digits.launch()
            self.gpu.launch("sort_scatter", self.sort_blocks, _SORT_THREADS, given)
            now, then = then, now
        self._sorted = *now, *then
        given = self._arguments(*self._sorted)
        self.gpu.launch("find_tiles", -(-(self.capacity + 1) // _SEARCHERS), _SEARCHERS, given)

    def over_tiles(self, kernel: str) -> None:
        """`forward`, `error` or `absolute_error`, a block for each tile, after `bin`."""
        given = self._arguments(*self._sorted)
        self.gpu.launch(f"{kernel}_{self.channels}", self.view.tiles, _TILE_THREADS, given)

    def reduce(self) -> None:
        """Gradients of Gaussians, after a pass that left moments of pairs."""
        given = self._arguments(*self._sorted)
        self.gpu.launch(f"reduce_{self.channels}", -(-self.gaussians // _THREADS), _THREADS, given)

    def set(self, **fields: Any) -> None:
        """Changes arguments of passes to come."""
        self._fields |= fields

    def _arguments(self, keys: GpuArray, slots: GpuArray, *rest: Any) -> ctypes.Structure:
        out_keys, out_slots, *shift = rest
        places = {"keys": keys, "slots": slots, "keys_out": out_keys, "slots_out": out_slots}
        addresses = {name: array.address for name, array in places.items()}
        return structures()["RasterArguments"](**self._fields, **addresses, shift=shift[0] if shift else 0)
