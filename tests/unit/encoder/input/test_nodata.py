"""Pixels that hold nothing continue those around them."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.encoder.input.nodata import inpaint


def test_other_pixels_stay() -> None:
    rng = np.random.default_rng(1)
    image = rng.random((3, 37, 50), np.float32)
    empty = rng.random((37, 50)) < 0.6
    filled = inpaint(image, empty)
    np.testing.assert_array_equal(filled[:, ~empty], image[:, ~empty])


@pytest.mark.parametrize("shape", [(40, 40), (1, 9), (33, 7)])
def test_a_flat_picture_stays_flat(shape: tuple[int, int]) -> None:
    empty = np.random.default_rng(2).random(shape) < 0.8
    empty[0, 0] = False
    image = np.where(empty, np.float32(9), np.float32(0.25))[None]
    np.testing.assert_allclose(inpaint(image, empty), 0.25, atol=1e-6)


def test_no_values_beyond_those_around() -> None:
    image = np.zeros((1, 64, 64), np.float32)
    image[:, :, 32:] = 1
    empty = np.zeros((64, 64), bool)
    empty[10:50, 20:44] = True
    filled = inpaint(image, empty)[0]
    assert filled.min() >= 0
    assert filled.max() <= 1 + 1e-6
    assert np.abs(np.diff(filled[30])).max() < 0.3  # no step where there was one before


def test_nothing_anywhere_is_zero() -> None:
    assert not inpaint(np.ones((2, 5, 6), np.float32), np.ones((5, 6), bool)).any()
