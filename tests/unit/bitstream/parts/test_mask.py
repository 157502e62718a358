"""Masks come back, and cost what their outlines cost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis.extra.numpy import array_shapes, arrays
from page_bits import QUICK, BitModels
from reference_decoder import Bits

from sgicodec._native import Mask
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.mask import write_mask
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.bitstream.varint import encode_varint
from sgicodec.errors import CorruptStreamError
from sgicodec.profiles.default import default_spec

MASKS = arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=40))


def read_mask(mask: bytes, width: int, height: int) -> Mask:
    """That of a picture whose only tile has this mask; one that says nothing is refused."""
    header = Header(width, height, "rgba", "uint8", (0.0, 255.0), "default", default_spec(4), 0, 0)
    payload = b"\2" + encode_varint(len(mask)) + mask
    (found,) = decode_tile_chunk(replace(header, masked="transparent"), payload).masks
    assert found is not None
    return found


def pixels(mask: Mask, width: int, height: int) -> np.ndarray:
    """The whole mask."""
    return mask.at(np.arange(height), np.arange(width))


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
    """docs/format.md, "Masks", over dictionaries of squares and of pixels."""

    def __init__(self, payload: bytes, width: int, height: int) -> None:
        self.bits, self.models, self.size = Bits(payload), BitModels(), (height, width)
        self.states: dict[tuple[int, int, int], int] = {}  # by side, row and column
        self.known: dict[tuple[int, int], int] = {}
        for y in range(0, height, 256):
            for x in range(0, width, 256):
                self.square(256, y, x)
        assert self.bits.ends_well()

    def flag(self, number: int) -> int:
        return self.bits.note(self.models.bit(self.bits.bit, QUICK, ("state", number)))

    def state(self, side: int, y: int, x: int) -> int:
        large = self.states.get((256, y & ~255, x & ~255), 3)
        return self.states.get((16, y, x), 3) if side == 16 and large == 2 else large

    def square(self, side: int, y: int, x: int) -> None:
        height, width = self.size
        near = [(y, x - side), (y - side, x), (y - side, x - side), (y - side, x + side)]
        c = 256 * (side == 256) + sum(w * self.state(side, *at) for w, at in zip((64, 16, 4, 1), near, strict=True))
        state = 2 if self.flag(2 * c) else self.flag(2 * c + 1)
        self.states[side, y, x] = state
        rows, columns = range(y, min(y + side, height)), range(x, min(x + side, width))
        if state == 2 and side == 256:
            for row in rows[::16]:
                for column in columns[::16]:
                    self.square(16, row, column)
        elif state == 2:
            for row in rows:
                for column in columns:
                    self.known[row, column] = self.pixel(row, column, y, columns)
        else:
            self.known |= {(row, column): state for row in rows for column in columns}

    def pixel(self, y: int, x: int, top: int, columns: range) -> int:
        def p(u: int, v: int) -> int:
            beyond = y + v >= top and x + u > columns[-1]
            return self.known.get((y + v, columns[-1] if beyond else x + u), 0)

        def number(*around: tuple[int, int]) -> int:
            return int("".join(str(p(*at)) for at in around), 2)

        left, row = (-1, 0), [(u, -1) for u in range(-3, 4)]
        f = number(*row[2:5], left)
        models = (
            f,
            16 + 4 * f + number((-2, 0), (0, -2)),
            80 + number((-1, -2), (0, -2), (1, -2), *row[1:6], (-2, 0), left),
            1104 + number(*row, left),
        )
        return self.bits.note(self.models.bit(self.bits.bit, QUICK, *models))

    @property
    def pixels(self) -> np.ndarray:
        return np.array([self.known[y, x] for y, x in np.ndindex(*self.size)], bool).reshape(self.size)


def test_the_page_reads_squares_of_256() -> None:
    """Clear and set ones, mixed ones beside them, and those that the tile cuts."""
    y, x = np.mgrid[:300, :1100]
    mask = (x > 500) & (x + y < 1050) | ((x - 100) ** 2 + (y - 90) ** 2 < 2000)
    np.testing.assert_array_equal(PageMask(write_mask(mask), 1100, 300).pixels, mask)
    np.testing.assert_array_equal(pixels(read_mask(write_mask(mask), 1100, 300), 1100, 300), mask)


@settings(max_examples=examples(30))
@given(MASKS)
def test_the_page_reads_the_same(mask: np.ndarray) -> None:
    height, width = mask.shape
    np.testing.assert_array_equal(PageMask(write_mask(mask), width, height).pixels, mask)
