"""Variance around pixels against sums over each window."""

import numpy as np
import pytest

from sgicodec.metrics.local_variance import local_variance


@pytest.mark.parametrize("shape", [(1, 1), (3, 40), (70, 5), (150, 31)])
def test_it_is_the_variance_in_each_window(shape: tuple[int, int]) -> None:
    plane = np.random.default_rng(1).normal(3, 2, shape)
    found = local_variance(plane)
    for y, x in np.ndindex(shape):
        window = plane[max(y - 5, 0) : y + 6, max(x - 5, 0) : x + 6]
        assert found[y, x] == pytest.approx(window.var(), abs=1e-10)
