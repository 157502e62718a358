"""Masks: which pixels hold nothing, as a quadtree of equal areas (docs/format.md, "Masks").

A node is all 0, all 1 or mixed; the children of mixed nodes are coded level by level under adaptive probabilities. Each
context is what is known of the four neighbours by then: their state, or that of their parent.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.symbol_coder import SymbolCoder, SymbolReader, SymbolWriter
from sgicodec.bitstream.entropy.tables import TOTAL

__all__ = ["read_mask", "write_mask"]

Mask = NDArray[np.bool_]
States = NDArray[np.uint8]

_CLEAR, _SET, _MIXED = 0, 1, 2
_CONTEXTS = 81


def write_mask(mask: Mask) -> bytes:
    """The payload of a mask [h, w]."""
    coder = SymbolWriter()
    _code(coder, mask, mask.shape[1], mask.shape[0])
    return coder.finish()


def read_mask(payload: bytes, width: int, height: int) -> Mask:
    """The mask [height, width] of a payload. Raises CorruptStreamError."""
    coder = SymbolReader(payload)
    mask = _code(coder, None, width, height)
    coder.finish()
    return mask


def _code(coder: SymbolCoder, mask: Mask | None, width: int, height: int) -> Mask:
    top = max(width - 1, height - 1, 1).bit_length()
    known = None if mask is None else _pyramid(mask, top)
    inner, bottom = np.zeros((_CONTEXTS, 3), np.int64), np.zeros((_CONTEXTS, 2), np.int64)
    states: States = np.full((1, 1), _MIXED, np.uint8)
    for level in range(top - 1, -1, -1):
        rows, columns = -(-height >> level), -(-width >> level)
        mixed = states == _MIXED
        states = states.repeat(2, axis=0).repeat(2, axis=1)[:rows, :columns]
        counts = bottom if level == 0 else inner
        for child in range(4):
            y, x = np.nonzero(mixed)
            y, x = 2 * y + child // 2, 2 * x + child % 2
            inside = (y < rows) & (x < columns)
            y, x = y[inside], x[inside]
            if not len(y):
                continue
            contexts = _contexts(states, y, x)
            given = None if known is None else known[level][y, x]
            coded = coder.code_categorical(given, _frequencies(counts), contexts)
            np.add.at(counts, (contexts, coded), 1)
            states[y, x] = coded
    return np.asarray(states == _SET)


def _pyramid(mask: Mask, top: int) -> list[States]:
    """The states of all nodes, from pixels to the level below the root."""
    result = [mask.astype(np.uint8)]
    for _ in range(1, top):
        rows, columns = result[-1].shape
        padded = np.pad(result[-1], ((0, rows % 2), (0, columns % 2)), mode="edge")
        four = np.stack([padded[::2, ::2], padded[::2, 1::2], padded[1::2, ::2], padded[1::2, 1::2]])
        result.append(np.where((four == four[0]).all(axis=0), four[0], _MIXED).astype(np.uint8))
    return result


def _contexts(states: States, y: NDArray[np.intp], x: NDArray[np.intp]) -> NDArray[np.int64]:
    """Context numbers from the left, right, upper and lower neighbours, the edge's own state beyond the edge."""
    rows, columns = states.shape
    contexts = np.zeros(len(y), np.int64)
    for dy, dx in ((0, -1), (0, 1), (-1, 0), (1, 0)):
        near = states[np.clip(y + dy, 0, rows - 1), np.clip(x + dx, 0, columns - 1)]
        contexts = 3 * contexts + near
    return contexts


def _frequencies(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Integers that sum to 2²⁴ in every row, in proportion to 1 + 2 · count."""
    weights = 1 + 2 * counts
    total = weights.sum(axis=1, keepdims=True)
    frequencies = 1 + (TOTAL - counts.shape[1]) * weights // total
    frequencies[:, 0] += TOTAL - frequencies.sum(axis=1)
    return np.asarray(frequencies, np.int64)
