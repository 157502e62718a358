"""Seed positions: a quadtree under adaptive models; of the uniform layout pixels, by how many others lie between."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.parts.arrays import write_weights
from sgicodec.errors import UsageError

__all__ = ["Seeds", "write_positions", "write_tree"]

Seeds = tuple[NDArray[np.int32], NDArray[np.int8]]
"""Corners [N, 2] in pixels (x, y) and log2 of the side of each one's node [N]."""

_COUNT_BITS, _SHIFT_BITS = 32, 4
_UPPER_BITS = 5
"""Of a gap of the mean size; those below are as good as random, and are coded as raw values."""


def write_tree(writer: SymbolWriter, size: tuple[int, int], seeds: Seeds) -> None:
    """Writes seeds as a quadtree in a tile of `size` (width, height). Raises UsageError for seeds that are no nodes of
    the tree, or share one.
    """
    flags, ones, content = _native.write_tree(size, *seeds)
    writer.flags(flags, ones, flags, content)


def write_positions(writer: SymbolWriter, size: tuple[int, int], seeds: Seeds) -> None:
    """Writes seeds of one pixel each in a tile of `size` (width, height). Raises UsageError for any others."""
    corner, log_size = np.asarray(seeds[0], np.int64).reshape(-1, 2), np.asarray(seeds[1])
    if log_size.any() or not ((corner >= 0) & (corner < size)).all():
        raise UsageError("positions: a seed that is no pixel of the tile")
    gaps = np.diff(np.sort(corner[:, 1] * size[0] + corner[:, 0]), prepend=-1) - 1
    if (gaps < 0).any():
        raise UsageError("positions: two seeds share one pixel")
    writer.code_int(len(gaps), _COUNT_BITS)
    if not len(gaps):
        return
    shift = int(np.clip(int(gaps.mean()).bit_length() - _UPPER_BITS, 0, (1 << _SHIFT_BITS) - 1))
    writer.code_int(shift, _SHIFT_BITS)
    writer.code_bits(gaps & (1 << shift) - 1, shift)
    upper = gaps >> shift
    write_weights(writer, np.where(upper & 1, -(upper + 1) // 2, upper // 2), upper.shape)
