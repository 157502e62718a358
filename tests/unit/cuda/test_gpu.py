"""Memory, launches and exclusive sums, on a driver that checks them (tests/support/fake_cuda.cpp)."""

from __future__ import annotations

import gc

import numpy as np
import pytest
from fake_cuda import fake_driver, fake_gpu

from sgicodec.cuda.driver import CudaError
from sgicodec.cuda.scan import ITEMS, THREADS, Scan
from sgicodec.cuda.structures import structures


def test_arrays_go_and_come() -> None:
    for values in (np.arange(12, dtype=np.int8).reshape(3, 4), np.zeros((0, 3), np.float32), np.float64([1.5])):
        held = fake_gpu().put(values)
        found = held.download()
        assert (found.shape, found.dtype) == (values.shape, values.dtype)
        np.testing.assert_array_equal(found, values)
    assert held.last() == 1.5
    assert fake_gpu().put(np.arange(12, dtype=np.int8).reshape(3, 4)).last() == 11
    with pytest.raises(ValueError, match="is not"):
        held.upload(np.float32([1.5]))


def test_memory_is_freed_with_its_array() -> None:
    gc.collect()
    allocated = fake_driver().sgi_fake_allocated
    before = allocated()
    held = fake_gpu().array((100, 100))
    assert allocated() == before + 40000
    del held
    assert allocated() == before


def test_what_fails_says_why() -> None:
    gpu, given = fake_gpu(), structures()["ScanArguments"]()
    with pytest.raises(MemoryError, match="too little memory"):
        gpu.array(1 << 40)
    with pytest.raises(CudaError, match="cuModuleGetFunction"):
        gpu.launch("no_such_kernel", 1, 32, given)
    with pytest.raises(CudaError, match="cuLaunchKernel"):
        gpu.launch("scan_totals", 1, THREADS - 1, given)


CHUNK = ITEMS * THREADS


@pytest.mark.parametrize("count", [0, 1, 7, CHUNK - 1, CHUNK, CHUNK + 1, 5 * CHUNK + 3, (THREADS + 2) * CHUNK])
def test_each_is_the_sum_of_those_before(count: int) -> None:
    values = np.random.default_rng(count).integers(0, 9, count + 1).astype(np.int32)
    held = fake_gpu().put(values)
    Scan(fake_gpu(), held, count).launch()
    np.testing.assert_array_equal(held.download(), np.concatenate([[0], np.cumsum(values[:count])]))
