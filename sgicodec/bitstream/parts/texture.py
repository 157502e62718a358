"""The texture of a tile, as native code has it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.model.texture_symbols import TextureGrid, TextureIndices, TextureSymbols

Steps = tuple[int, list[int], tuple[int, int], tuple[int, int, int], bool, tuple[int, int, int], tuple[bool, int, int]]
Read = tuple[Steps, NDArray[np.uint8], NDArray[np.int8], NDArray[np.int16]]


def layer_of(read: Read | None, size: tuple[int, int]) -> TextureSymbols | None:
    """The layer of a tile of `size` as native code read it."""
    if read is None:
        return None
    (step, ratios, slopes, excess, has_contrast, colours, grid), log_size, contrast, symbols = read
    steps = TextureIndices(step, tuple(ratios), slopes, excess, has_contrast, colours)
    return TextureSymbols(size, steps, log_size, contrast, symbols, TextureGrid(*grid))
