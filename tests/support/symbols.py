"""Symbols of a payload, written and read part by part by the extension, in the forms in which tests have them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgicodec import _native
from sgicodec.model.texture_symbols import TextureSymbols

Seeds = tuple[NDArray[np.int32], NDArray[np.int8]]
"""Corners [N, 2] in pixels (x, y) and log2 of the side of each one's node [N]."""

_MANY = 1 << 62


class SymbolWriter(_native.SymbolWriter):
    """Writes a payload."""

    def code(self, symbols: ArrayLike, tables: ArrayLike) -> None:  # type: ignore[override]
        """Zero-centred integers, each with its own table."""
        super().code(np.asarray(symbols, np.int32).reshape(-1), np.asarray(tables, np.int16).reshape(-1))

    def code_bits(self, values: ArrayLike, n_bits: int) -> None:  # type: ignore[override]
        """Equally likely integers."""
        super().code_bits(np.asarray(values, np.uint32).reshape(-1), n_bits)

    def code_int(self, value: int, n_bits: int) -> None:
        """One of them."""
        self.code_bits([value], n_bits)

    def flags(self, bits: NDArray[np.int32], ones: NDArray[np.int32], symbols: NDArray[np.int32]) -> None:
        """Bits that are 1 with probabilities ones / 2^16, which spell `symbols`."""
        super().code_flags(bits, ones)
        super().record(np.asarray(symbols, np.int32))


class SymbolReader(_native.SymbolReader):
    """Reads a payload."""

    def read(self, tables: ArrayLike) -> NDArray[np.int32]:
        """Zero-centred integers, each with its own table."""
        tables = np.asarray(tables, np.int16)
        return self.code(np.zeros(tables.shape, np.int32), tables)

    def read_flags(self, ones: NDArray[np.int32]) -> NDArray[np.int32]:
        """Bits that are 1 with probabilities ones / 2^16."""
        return self.code_flags(np.zeros_like(ones), ones)

    def read_bits(self, n_bits: int, count: int) -> NDArray[np.uint32]:
        """Equally likely integers."""
        return self.code_bits(np.zeros(count, np.uint32), n_bits)

    def read_weights(self, count: int) -> NDArray[np.int64]:
        """A tensor of so many integers."""
        return self.code_weights(np.zeros(count, np.int64))

    def read_signs(self, counts: list[int]) -> NDArray[np.uint8]:
        """The hash grid's signs, level after level."""
        return self.code_signs(np.zeros(sum(counts), np.uint8), counts)

    def read_base(self, *shape: int) -> NDArray[np.int64]:
        """Planes of the base layer."""
        return self.code_base(np.zeros(shape, np.int64))

    def read_positions(self, size: tuple[int, int], most: int) -> Seeds:
        """Seeds of one pixel."""
        return self.code_seeds(size, False, *_nowhere(), most)

    def read_tree(self, size: tuple[int, int], most: int) -> Seeds:
        """Seeds in a quadtree."""
        return self.code_seeds(size, True, *_nowhere(), most)


def _nowhere() -> Seeds:
    return np.zeros((0, 2), np.int32), np.zeros(0, np.int8)


def write_weights(writer: SymbolWriter, weights: ArrayLike) -> None:
    """A tensor of integers."""
    writer.code_weights(np.asarray(weights, np.int64).reshape(-1))


def write_signs(writer: SymbolWriter, signs: ArrayLike, counts: Sequence[int]) -> None:
    """The hash grid's signs, level after level."""
    writer.code_signs(np.asarray(signs, np.uint8), list(counts))


def write_base(writer: SymbolWriter, planes: NDArray[np.integer]) -> None:
    """Planes of the base layer."""
    writer.code_base(planes.astype(np.int64))


def write_positions(writer: SymbolWriter, size: tuple[int, int], seeds: Seeds) -> None:
    """Seeds of one pixel."""
    writer.code_seeds(size, False, *seeds, _MANY)


def write_tree(writer: SymbolWriter, size: tuple[int, int], seeds: Seeds) -> None:
    """Seeds in a quadtree."""
    writer.code_seeds(size, True, *seeds, _MANY)


def write_texture(writer: SymbolWriter, size: tuple[int, int], channels: int, layer: TextureSymbols | None) -> None:
    """A tile's texture, None for none."""
    writer.write_texture(size, channels, layer)
