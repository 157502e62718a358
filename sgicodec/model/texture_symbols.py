"""A texture layer: windowed cosines in the cells of a quadtree, as symbols and their steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import TEXTURE_ROOT_LOG, draw_texture
from sgicodec.arrays import F32
from sgicodec.device import ONE_THREAD, Device

Beyond = Literal["constant", "edge", "symmetric"]

SAME_COLOURS = 32, 32, 8
"""Of a layer in the channels of its tile."""


class TextureGrid(NamedTuple):
    """Where the cells of a layer lie: they lap over their neighbours and begin with the tile, or they are separate, and
    the first ones begin 0 to 7 pixels before it.
    """

    separate: bool = False
    left: int = 0
    top: int = 0

    def layer_size(self, size: tuple[int, int]) -> tuple[int, int]:
        """Width and height of a layer: those of its tile and of what lies before it."""
        return size[0] + self.left, size[1] + self.top

    def layer_planes(self, planes: NDArray[Any], beyond: Beyond) -> NDArray[Any]:
        """Planes [..., H, W] of a tile as those of a layer; beyond: the mode of np.pad."""
        if not (self.left or self.top):
            return planes
        return np.pad(planes, [(0, 0)] * (planes.ndim - 2) + [(self.top, 0), (self.left, 0)], mode=beyond)


LAPPED = TextureGrid()


@dataclass(frozen=True)
class TextureIndices:
    """What a symbol stands for, as indices of the stream.

    step: of the first channel's lowest frequency, 2^((step − 480) / 32); ratios: [C − 1] of the other channels' steps
    to that, 2^((ratio − 16) / 8). slopes: by which steps grow towards the highest frequency, in halves, of the first
    channel and of the others. excess: what is added to the magnitude of symbols ±1, ±2 and larger ones, (index − 8) /
    32. has_contrast: whether superblocks have a contrast, which scales their steps by 2^(contrast / 4). colours: those
    in which the layer is coded: shares of its first channel in the two differences, (index − 32) / 64, and the
    turn of its others, (index − 8) π / 32.
    """

    step: int
    ratios: tuple[int, ...] = ()
    slopes: tuple[int, int] = (0, 0)
    excess: tuple[int, int, int] = (8, 8, 8)
    has_contrast: bool = False
    colours: tuple[int, int, int] = SAME_COLOURS

    @property
    def of_channels(self) -> F32:
        """Steps at the lowest frequency [C], samples in 0..1."""
        ratios = [1.0, *(2.0 ** ((ratio - 16) / 8) for ratio in self.ratios)]
        return np.array([2.0 ** ((self.step - TEXTURE_STEP_ZERO) / 32) * ratio for ratio in ratios], np.float32)

    @property
    def growth(self) -> tuple[float, float]:
        """The slopes as numbers."""
        return self.slopes[0] / 2, self.slopes[1] / 2

    def at_frequency(self, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
        """Steps of the first channel at frequencies (1 at a period of two pixels), samples in 0..1."""
        return np.asarray(self.of_channels.item(0) * (1 + 0.5 * self.growth[0] * frequency**2))


TEXTURE_STEP_ZERO, TEXTURE_STEP_COUNT = 480, 512
SAME_STEP = 16
"""Ratio of a channel with the steps of the first."""
MAX_SLOPE = 31
"""That a stream can state."""


def texture_step_index(step: float) -> int:
    """Index of the step nearest to `step`, samples in 0..1."""
    return int(np.clip(np.rint(32 * np.log2(step)) + TEXTURE_STEP_ZERO, 0, TEXTURE_STEP_COUNT - 1))


def roots_of(width: int, height: int) -> tuple[int, int]:
    """Columns and rows of superblocks of a tile."""
    side = 1 << TEXTURE_ROOT_LOG
    return -(-width // side), -(-height // side)


def whole_roots(planes: NDArray[Any], beyond: Beyond) -> NDArray[Any]:
    """Planes [..., H, W] that fill whole superblocks [..., 32 rows, 32 columns]; beyond: the mode of np.pad."""
    *others, height, width = planes.shape
    columns, rows = roots_of(width, height)
    margins = (0, (rows << TEXTURE_ROOT_LOG) - height), (0, (columns << TEXTURE_ROOT_LOG) - width)
    if margins == ((0, 0), (0, 0)):
        return planes
    return np.pad(planes, [(0, 0)] * len(others) + list(margins), mode=beyond)


def root_blocks(plane: NDArray[Any]) -> NDArray[Any]:
    """A plane [H, W] by its superblocks [rows, 32, columns, 32], which repeat its edges beyond it."""
    whole, side = whole_roots(plane, "edge"), 1 << TEXTURE_ROOT_LOG
    return whole.reshape(len(whole) >> TEXTURE_ROOT_LOG, side, whole.shape[1] >> TEXTURE_ROOT_LOG, side)


@dataclass(frozen=True)
class TextureSymbols:
    """A layer of a tile of `size` (width, height) whose superblocks are `rows` by `columns`, on `grid`.

    log_size [4 rows, 4 columns]: log2 of the side of the cell with texture that covers 8×8 pixels, 0 for none. contrast
    [rows, columns]: of each superblock. symbols [C, 32 rows, 32 columns]: those of a cell [n, n] where its pixels are,
    vertical frequency first.
    """

    size: tuple[int, int]
    steps: TextureIndices
    log_size: NDArray[np.uint8]
    contrast: NDArray[np.int8]
    symbols: NDArray[np.int16]
    grid: TextureGrid = LAPPED

    @property
    def is_empty(self) -> bool:
        """Whether no cell has texture."""
        return not self.log_size.any()

    def draw(self, device: Device = ONE_THREAD) -> F32:
        """What the layer adds to the channels of the tile [C, H, W]."""
        return draw_texture(self, device.threads, device.isa)
