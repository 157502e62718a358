from __future__ import annotations

import numpy as np
import pytest

from sgicodec.image.alpha import unassociate


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
def test_integers_come_back_when_multiplied_again(dtype: str) -> None:
    largest = int(np.iinfo(dtype).max)
    random = np.random.default_rng(1)
    alpha = random.integers(1, largest, 4000, endpoint=True)
    colour = random.integers(0, alpha, endpoint=True)
    divided = unassociate(np.stack([colour, alpha], -1).astype(dtype)[None])
    again = np.rint(divided[0, :, 0].astype(np.float64) * alpha / largest)
    np.testing.assert_array_equal(again, colour)
    np.testing.assert_array_equal(divided[0, :, 1], alpha)


def test_brighter_than_alpha_is_clipped_and_no_alpha_keeps_its_colour() -> None:
    pixels = np.array([[[200, 100], [77, 0], [0, 9]]], np.uint8)
    assert unassociate(pixels)[0].tolist() == [[255, 100], [77, 0], [0, 9]]
    assert pixels[0, 0, 0] == 200
