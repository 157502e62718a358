"""Masks: which pixels hold nothing, as a quadtree of equal areas (docs/format.md, "Masks").

A node is all 0, all 1 or mixed; the children of mixed nodes are coded level by level under adaptive probabilities. Each
context is what is known of the four neighbours by then: their state, or that of their parent.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import TOTAL
from sgicodec.errors import PictureError

__all__ = ["MAX_NODES", "NODES_PER_BYTE", "write_mask"]

Mask = NDArray[np.bool_]
States = NDArray[np.uint8]
Links = NDArray[np.int32]
Ints = NDArray[np.int64]

MAX_NODES, NODES_PER_BYTE = 3 << 17, 32
"""Mixed nodes that a reader takes, and more for each byte of a mask's payload."""

CLEAR, SET, BEYOND = -1, -2, -3
"""What a link says instead of a node's number: all pixels hold something, none does, or there are none."""
_MIXED, _NONE = 2, 3
_LINKS = np.array([CLEAR, SET, 0, BEYOND], np.int32)
"""The link to a child of each state, but for the numbers of mixed ones."""
_STATES = np.array([1, 0, 2], np.uint8)
"""The state that stands for SET, CLEAR and BEYOND, counted from SET: beyond the edge it is the node's own, mixed."""
_CONTEXTS = 81

_DOWN, _ACROSS = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])
"""Where children lie."""
_SIDES = ((0, 1), (0, 1), (1, 2), (1, 2))
"""Of the left, right, upper, lower neighbour: the axis (0 across, 1 down), and what a child's number changes by."""


def write_mask(mask: Mask) -> bytes:
    """The payload of a mask [h, w]. Raises PictureError for one of more nodes than a reader takes."""
    writer, (height, width) = SymbolWriter(), mask.shape
    top = max(width - 1, height - 1, 1).bit_length()
    known = _pyramid(mask, top)
    inner, bottom = np.zeros((_CONTEXTS, 3), np.int64), np.zeros((_CONTEXTS, 2), np.int64)
    y, x = np.zeros(1, np.int64), np.zeros(1, np.int64)  # of the mixed nodes, row by row
    near = np.full((4, 1), BEYOND, np.int32)  # links to their neighbours
    nodes = 0
    for level in range(top - 1, -1, -1):
        nodes += len(y)
        states = _write_level(writer, known[level], y, x, near, inner if level else bottom)
        links, node, child = _linked(states, known[level].shape[1], y, x)
        near = np.stack([_beside(links, near, node, child, side) for side in range(4)])
        y, x = 2 * y[node] + _DOWN[child], 2 * x[node] + _ACROSS[child]
    payload = writer.finish()
    if nodes > MAX_NODES + NODES_PER_BYTE * len(payload):
        text = "it alternates between pixels with and without content in too many places"
        raise PictureError(f"{width}×{height} pixels are too many for the mask of one tile: {text}; choose --tile 1024")
    return payload


def _write_level(
    writer: SymbolWriter, known: States, y: Ints, x: Ints, near: Links, counts: NDArray[np.int64]
) -> States:
    """The states [n, 4] of the children of the mixed nodes, _NONE for those beyond the edge. known: of all nodes."""
    states: States = np.full((len(y), 4), _MIXED, np.uint8)
    rows_of_all, columns_of_all = known.shape
    for child in range(4):
        rows, columns = 2 * y + _DOWN[child], 2 * x + _ACROSS[child]
        (inside,) = np.nonzero((rows < rows_of_all) & (columns < columns_of_all))
        contexts = np.zeros(len(inside), np.int64)
        for side in range(4):
            contexts = 3 * contexts + _state_beside(states, near, inside, child, side)
        given = known[rows[inside], columns[inside]]
        writer.code_categorical(given, _frequencies(counts), contexts)
        kinds = counts.shape[1]
        counts += np.bincount(kinds * contexts + given, minlength=counts.size).reshape(counts.shape)
        states[inside, child] = given
    y, x = y[:, None], x[:, None]
    states[(2 * y + _DOWN >= rows_of_all) | (2 * x + _ACROSS >= columns_of_all)] = _NONE
    return states


def _sibling(child: int, side: int) -> tuple[bool, int]:
    """Whether the neighbour on a side has the same parent, and which of its parent's children it is."""
    axis, step = _SIDES[side]
    ahead = side % 2 == 1
    return (child >> axis & 1) != ahead, child ^ step


def _state_beside(states: States, near: Links, nodes: Ints, child: int, side: int) -> States:
    """What is known of the neighbours on a side of one child of these nodes."""
    same, other = _sibling(child, side)
    if same:
        return np.asarray(states[nodes, other])
    links = near[side, nodes]
    beside = states[np.maximum(links, 0), other]
    return np.asarray(np.where(links >= 0, beside, _STATES[np.minimum(links, CLEAR) - SET]))


def _linked(states: States, columns: int, y: Ints, x: Ints) -> tuple[Links, Ints, Ints]:
    """The links [n, 4] to these children; then the mixed ones row by row, as numbers of their parents and as children.

    columns: nodes in a row of the children's level.
    """
    links = _LINKS[states]
    node, child = np.divmod(np.flatnonzero(states == _MIXED), 4)
    order = np.argsort((2 * y[node] + _DOWN[child]) * columns + 2 * x[node] + _ACROSS[child], kind="stable")
    node, child = node[order], child[order]
    links[node, child] = np.arange(len(order))
    return links, node, child


def _beside(links: Links, near: Links, node: Ints, child: Ints, side: int) -> Links:
    """Links to the neighbours on a side of these children, each of its node."""
    result = np.empty(len(node), np.int32)
    for number in range(4):
        (here,) = np.nonzero(child == number)
        same, other = _sibling(number, side)
        parents = node[here] if same else near[side, node[here]]
        result[here] = np.where(parents >= 0, links[np.maximum(parents, 0), other], parents)
    return result


def _pyramid(mask: Mask, top: int) -> list[States]:
    """The states of all nodes, from pixels to the level below the root."""
    result = [mask.astype(np.uint8)]
    for _ in range(1, top):
        rows, columns = result[-1].shape
        padded = np.pad(result[-1], ((0, rows % 2), (0, columns % 2)), mode="edge")
        four = np.stack([padded[::2, ::2], padded[::2, 1::2], padded[1::2, ::2], padded[1::2, 1::2]])
        result.append(np.where((four == four[0]).all(axis=0), four[0], _MIXED).astype(np.uint8))
    return result


def _frequencies(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Integers that sum to 2²⁴ in every row, in proportion to 1 + 2 · count."""
    weights = 1 + 2 * counts
    total = weights.sum(axis=1, keepdims=True)
    frequencies = 1 + (TOTAL - counts.shape[1]) * weights // total
    frequencies[:, 0] += TOTAL - frequencies.sum(axis=1)
    return np.asarray(frequencies, np.int64)
