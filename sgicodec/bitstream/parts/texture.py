"""The texture part of a tile: step sizes, then the layer under adaptive models (docs/format.md, "Texture")."""

from __future__ import annotations

import zlib
from functools import cache
from importlib.resources import files
from typing import Any

from numpy.typing import NDArray

from sgicodec._native import RangeDecoder, TextureModels
from sgicodec.bitstream.entropy.symbol_coder import IntArray, SymbolCoder, SymbolReader, SymbolWriter
from sgicodec.bitstream.limits import check_texture
from sgicodec.errors import CorruptStreamError, UnsupportedStreamError
from sgicodec.model.texture_symbols import TextureSteps, TextureSymbols

__all__ = ["code_texture", "texture_models"]

MODELS = {False: 1, True: 2}
"""Number of the shipped models for symbols that are dependent or not; the file of a number never changes."""
_MODELS_BITS, _STEP_BITS, _RATIO_BITS, _SLOPE_BITS, _EXCESS_BITS = 4, 9, 5, 5, 4


@cache
def texture_models(dependent: bool = True) -> TextureModels:
    """The shipped state of the adaptive models with which every layer begins."""
    packed = files(__package__).joinpath(f"texture{MODELS[dependent]}.bin").read_bytes()
    return TextureModels(dependent, zlib.decompress(packed))


def code_texture(
    coder: SymbolCoder, size: tuple[int, int], channels: int, texture: TextureSymbols | None
) -> TextureSymbols | None:
    """A tile's texture layer, None where it has none. size: width and height of the tile.

    Raises LimitError for a tile that is too large, CorruptStreamError where the payload does not decode,
    UnsupportedStreamError for models of another number.
    """
    if not coder.code_int(int(texture is not None), 1):
        return None
    check_texture(channels, *size)
    models = coder.code_int(None if texture is None else MODELS[texture.steps.dependent], _MODELS_BITS)
    if models not in MODELS.values():
        raise UnsupportedStreamError(f"texture: models {models}; this program has models 1 and 2")
    steps = _code_steps(coder, channels, models == MODELS[True], None if texture is None else texture.steps)
    if isinstance(coder, SymbolWriter) and texture is not None:
        parts = texture.log_size, texture.contrast, texture.symbols
        coder.flags(*texture_models(steps.dependent).write(*parts, size, steps.has_contrast))
        return texture
    if not isinstance(coder, SymbolReader):
        raise TypeError("a coder reads or writes")
    return _read(coder, size, channels, steps)


def _read(coder: SymbolReader, size: tuple[int, int], channels: int, steps: TextureSteps) -> TextureSymbols:
    """The layer behind its steps."""
    parts: list[NDArray[Any]] = []

    def read(decoder: RangeDecoder) -> tuple[int, IntArray, list[float]]:
        sound, layer, symbols, content = texture_models(steps.dependent).read(
            decoder, size, channels, steps.has_contrast
        )
        if not sound:
            raise CorruptStreamError("texture: the payload does not decode; it is damaged")
        parts.extend(layer)
        return 0, symbols, [content]

    coder.read(read, [coder.current])
    return TextureSymbols(size, steps, *parts)


def _code_steps(coder: SymbolCoder, channels: int, dependent: bool, steps: TextureSteps | None) -> TextureSteps:
    """The indices of the steps as raw values."""

    def several(values: tuple[int, ...] | None, n_bits: int, count: int) -> tuple[int, ...]:
        return tuple(coder.code_bits(values, n_bits, count).tolist())

    step = coder.code_int(None if steps is None else steps.step, _STEP_BITS)
    ratios = several(None if steps is None else steps.ratios, _RATIO_BITS, channels - 1)
    luma, chroma = several(None if steps is None else steps.slopes, _SLOPE_BITS, 2)
    one, two, more = several(None if steps is None else steps.excess, _EXCESS_BITS, 3)
    has_contrast = coder.code_int(None if steps is None else int(steps.has_contrast), 1)
    return TextureSteps(step, ratios, (luma, chroma), (one, two, more), bool(has_contrast), dependent)
