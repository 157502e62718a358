"""The texture part of a tile: step sizes, then the layer under adaptive models (docs/format.md, "Texture")."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import TextureModels
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.limits import check_texture
from sgicodec.model.texture_symbols import MAX_SLOPE, SAME_COLOURS, TextureGrid, TextureSteps, TextureSymbols

__all__ = ["layer_of", "texture_models", "write_texture"]

Steps = tuple[int, list[int], tuple[int, int], tuple[int, int, int], bool, tuple[int, int, int], tuple[bool, int, int]]
Read = tuple[Steps, NDArray[np.uint8], NDArray[np.int8], NDArray[np.int16]]

PLAIN, COLOURED = 2, 3
"""Whether a layer is in the channels of its tile or in colours of its own."""
_MODELS_BITS, _STEP_BITS, _RATIO_BITS, _EXCESS_BITS, _SHARE_BITS, _TURN_BITS, _GRID_BITS = 4, 9, 5, 4, 6, 4, 3
_SLOPE_BITS = MAX_SLOPE.bit_length()


@cache
def texture_models() -> TextureModels:
    """The shipped state of the adaptive models with which every layer begins."""
    return TextureModels.shipped()


def write_texture(writer: SymbolWriter, size: tuple[int, int], channels: int, texture: TextureSymbols | None) -> None:
    """A tile's texture layer, None where it has none. size: width and height of the tile.

    Raises LimitError for a tile that is too large.
    """
    writer.code_int(int(texture is not None), 1)
    if texture is None:
        return
    layer_size = texture.grid.layer_size(size)
    check_texture(channels, *layer_size)
    steps = texture.steps
    coloured = steps.colours != SAME_COLOURS
    if coloured and channels < 3:
        raise ValueError("colours are for three channels or more")
    writer.code_int(COLOURED if coloured else PLAIN, _MODELS_BITS)
    _write_steps(writer, steps, texture.grid)
    parts = texture.log_size, texture.contrast, texture.symbols
    writer.flags(*texture_models().write(*parts, layer_size, steps.has_contrast))


def _write_steps(writer: SymbolWriter, steps: TextureSteps, grid: TextureGrid) -> None:
    """The indices of the steps and the grid as raw values."""
    writer.code_int(steps.step, _STEP_BITS)
    writer.code_bits(steps.ratios, _RATIO_BITS)
    writer.code_bits(steps.slopes, _SLOPE_BITS)
    writer.code_bits(steps.excess, _EXCESS_BITS)
    writer.code_int(int(steps.has_contrast), 1)
    writer.code_int(int(grid.separate), 1)
    if grid.separate:
        writer.code_bits((grid.left, grid.top), _GRID_BITS)
    if steps.colours != SAME_COLOURS:
        writer.code_bits(steps.colours[:2], _SHARE_BITS)
        writer.code_int(steps.colours[2], _TURN_BITS)


def layer_of(read: Read | None, size: tuple[int, int]) -> TextureSymbols | None:
    """The layer of a tile of `size` as native code read it."""
    if read is None:
        return None
    (step, ratios, slopes, excess, has_contrast, colours, grid), log_size, contrast, symbols = read
    steps = TextureSteps(step, tuple(ratios), slopes, excess, has_contrast, colours)
    return TextureSymbols(size, steps, log_size, contrast, symbols, TextureGrid(*grid))
