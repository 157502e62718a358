"""Masks come back, and cost what their outlines cost."""

from __future__ import annotations

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from sgicodec._native import MaskTree, read_mask
from sgicodec.bitstream.parts.mask import write_mask
from sgicodec.errors import CorruptStreamError


def pixels(tree: MaskTree, width: int, height: int) -> np.ndarray:
    """The whole mask."""
    return tree.at(np.arange(height), np.arange(width))


@settings(max_examples=examples(60))
@given(arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=40)))
def test_any_mask_comes_back(mask: np.ndarray) -> None:
    height, width = mask.shape
    np.testing.assert_array_equal(pixels(read_mask(write_mask(mask), width, height), width, height), mask)


def _disc(side: int) -> np.ndarray:
    y, x = np.mgrid[:side, :side]
    return (x - side / 2) ** 2 + (y - side / 2) ** 2 > (0.4 * side) ** 2


def _corner(side: int) -> np.ndarray:
    y, x = np.mgrid[:side, :side]
    return x + 0.3 * y < 0.5 * side


@pytest.mark.parametrize(("mask", "outline"), [(_disc(1000), 800 * np.pi), (_corner(1000), 1000 * 1.05)])
def test_an_outline_costs_about_three_bits_a_pixel(mask: np.ndarray, outline: float) -> None:
    assert 8 * len(write_mask(mask)) < 3.1 * outline


@pytest.mark.parametrize("value", [False, True])
def test_equal_masks_cost_next_to_nothing(value: bool) -> None:
    assert len(write_mask(np.full((2000, 1500), value))) < 16


def test_damage_is_found() -> None:
    payload = bytearray(write_mask(_disc(64)))
    for at in range(len(payload)):
        payload[at] ^= 0x10
        with pytest.raises(CorruptStreamError):
            read_mask(bytes(payload), 64, 64)
        payload[at] ^= 0x10


@settings(max_examples=examples(60))
@given(arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=40)), st.data())
def test_any_rows_and_columns(mask: np.ndarray, data: st.DataObject) -> None:
    tree = read_mask(write_mask(mask), mask.shape[1], mask.shape[0])
    rows, columns = (np.sort(data.draw(st.lists(st.integers(0, size - 1), min_size=1))) for size in mask.shape)
    np.testing.assert_array_equal(tree.at(rows, columns), mask[np.ix_(rows, columns)])


def test_a_large_tree_is_small() -> None:
    tree = read_mask(write_mask(_disc(1000)), 1000, 1000)
    assert tree.nbytes < 100_000
    assert tree.is_mixed
    assert pixels(MaskTree(5, 3), 5, 3).all()
    with pytest.raises(ValueError, match="must not fall"):
        tree.at(np.array([1, 0]), np.array([0]))
