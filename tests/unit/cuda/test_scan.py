"""Exclusive sums on a GPU, of which the kernels are compiled for the host."""

from __future__ import annotations

import numpy as np
import pytest
from fake_cuda import fake_gpu

from sgicodec.cuda.scan import ITEMS, THREADS, Scan

CHUNK = ITEMS * THREADS


@pytest.mark.parametrize("count", [0, 1, 7, CHUNK - 1, CHUNK, CHUNK + 1, 5 * CHUNK + 3, (THREADS + 2) * CHUNK])
def test_each_is_the_sum_of_those_before(count: int) -> None:
    values = np.random.default_rng(count).integers(0, 9, count + 1).astype(np.int32)
    held = fake_gpu().put(values)
    Scan(fake_gpu(), held, count).launch()
    np.testing.assert_array_equal(held.download(), np.concatenate([[0], np.cumsum(values[:count])]))
