"""Masks come back, and cost what their outlines cost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis.extra.numpy import array_shapes, arrays

from sgicodec._native import MaskTree, SymbolReader
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.mask import write_mask
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.bitstream.varint import encode_varint
from sgicodec.errors import CorruptStreamError
from sgicodec.profiles.default import default_spec

MASKS = arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=40))


def read_mask(mask: bytes, width: int, height: int) -> MaskTree:
    """The tree of a picture whose only tile has this mask; one that says nothing is refused."""
    header = Header(width, height, "rgba", "uint8", (0.0, 255.0), "default", default_spec(4), 0, 0)
    payload = b"\2" + encode_varint(len(mask)) + mask
    (tree,) = decode_tile_chunk(replace(header, masked="transparent"), payload).masks
    assert tree is not None
    return tree


def pixels(tree: MaskTree, width: int, height: int) -> np.ndarray:
    """The whole mask."""
    return tree.at(np.arange(height), np.arange(width))


@settings(max_examples=examples(60))
@given(MASKS.filter(lambda mask: mask.any() and not mask.all()))
def test_any_mask_comes_back(mask: np.ndarray) -> None:
    height, width = mask.shape
    np.testing.assert_array_equal(pixels(read_mask(write_mask(mask), width, height), width, height), mask)


def _disc(side: int) -> np.ndarray:
    y, x = np.mgrid[:side, :side]
    return (x - side / 2) ** 2 + (y - side / 2) ** 2 > (0.4 * side) ** 2


def test_damage_is_found() -> None:
    payload = bytearray(write_mask(_disc(64)))
    for at in range(len(payload)):
        payload[at] ^= 0x10
        with pytest.raises(CorruptStreamError):
            read_mask(bytes(payload), 64, 64)
        payload[at] ^= 0x10


class PageMask:
    """docs/format.md, "Masks", one node at a time over a dictionary of states."""

    def __init__(self, payload: bytes, width: int, height: int) -> None:
        self.reader, self.size = SymbolReader(payload), (height, width)
        self.counts = {0: np.zeros((81, 2), int), 1: np.zeros((81, 3), int)}
        self.above, self.states = {(0, 0): 2}, {(0, 0): 2}
        for k in range(max(width - 1, height - 1, 1).bit_length() - 1, -1, -1):
            self.above, self.states = self.states, {}
            self.grid = -(-height >> k), -(-width >> k)
            for y, x in np.ndindex(*self.grid):
                if self.above[y >> 1, x >> 1] != 2:
                    self.states[y, x] = self.above[y >> 1, x >> 1]
            for child in range(4):
                self.read(child, self.counts[min(k, 1)])
        self.reader.finish()

    def known(self, y: int, x: int) -> int:
        if not (0 <= y < self.grid[0] and 0 <= x < self.grid[1]):
            return 2
        return self.states.get((y, x), self.above[y >> 1, x >> 1])

    def read(self, child: int, counts: np.ndarray) -> None:
        mixed = sorted(node for node, state in self.above.items() if state == 2)
        children = [(2 * y + (child >> 1), 2 * x + (child & 1)) for y, x in mixed]
        places = [(y, x) for y, x in children if y < self.grid[0] and x < self.grid[1]]
        contexts = []
        for y, x in places:
            sides = ((y, x - 1), (y, x + 1), (y - 1, x), (y + 1, x))
            contexts.append(sum(w * self.known(*side) for w, side in zip((27, 9, 3, 1), sides, strict=True)))
        weights = 1 + 2 * counts
        frequencies = 1 + ((1 << 24) - weights.shape[1]) * weights // weights.sum(axis=1, keepdims=True)
        frequencies[:, 0] += (1 << 24) - frequencies.sum(axis=1)
        found = self.reader.read_categorical(frequencies, np.array(contexts, np.int16)).tolist()
        np.add.at(counts, (contexts, found), 1)
        self.states |= dict(zip(places, found, strict=True))

    @property
    def pixels(self) -> np.ndarray:
        return np.array([self.states[y, x] for y, x in np.ndindex(*self.size)], bool).reshape(self.size)


@settings(max_examples=examples(30))
@given(MASKS)
def test_the_page_reads_the_same(mask: np.ndarray) -> None:
    height, width = mask.shape
    np.testing.assert_array_equal(PageMask(write_mask(mask), width, height).pixels, mask)
