"""Small integer arrays of a tile: network weights, the base layer, the signs of the hash grid.

Shapes come from the header. The table that the encoder chose precedes the array as raw bits.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import TABLES, frequency_tables
from sgicodec.errors import UsageError

__all__ = ["base_errors", "write_base", "write_signs", "write_weights"]

_TABLE_BITS = (TABLES - 1).bit_length()


def write_weights(writer: SymbolWriter, weights: ArrayLike, shape: tuple[int, ...]) -> None:
    """One tensor of integers under the one zero-centred table that suits it best."""
    values = _shaped(weights, shape)
    table = frequency_tables().best(values)
    writer.code_int(table, _TABLE_BITS)
    writer.code(values, np.full(shape, table, np.int16))


def write_signs(writer: SymbolWriter, bits: ArrayLike, counts: Sequence[int]) -> None:
    """Σ counts values 0 or 1, level after level, each level under an adaptive model of its own."""
    values = _shaped(bits, (sum(counts),))
    if np.any((values < 0) | (values > 1)):
        raise UsageError("signs: values must be 0 or 1")
    signs, ones, content = _native.write_signs(values.astype(np.int32), list(counts))
    writer.flags(signs, ones, signs, content)


def write_base(writer: SymbolWriter, base: ArrayLike, shape: tuple[int, int, int]) -> None:
    """Planes [C, h, w] of a smooth picture in integer steps: what each value has more than its prediction."""
    for errors in base_errors(_shaped(base, shape)):
        write_weights(writer, errors, shape[1:])


def base_errors(planes: NDArray[np.int64]) -> NDArray[np.int64]:
    """What values of planes [C, h, w] have more than the mean of those to the left and above; at an edge the one that
    there is stands for both.
    """
    west, north = np.zeros_like(planes), np.zeros_like(planes)
    west[:, :, 1:], north[:, 1:] = planes[:, :, :-1], planes[:, :-1]
    west[:, 1:, 0], north[:, 0] = north[:, 1:, 0], west[:, 0]
    return planes - ((west + north) >> 1)


def _shaped(values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.int64]:
    array = np.asarray(values, np.int64)
    if array.shape != shape:
        raise UsageError(f"array of shape {array.shape} where the header says {shape}")
    return array
