"""Exclusive sums over integers in the memory of a GPU."""

from __future__ import annotations

import numpy as np

from sgicodec.cuda import sources
from sgicodec.cuda.gpu import Gpu, GpuArray
from sgicodec.cuda.structures import structures

_SIZES = sources.constants("cuda/base/scan.hpp")
THREADS, ITEMS = _SIZES["kScanThreads"], _SIZES["kScanItems"]


class Scan:
    """Turns the first `count` of `values` into the sum of those before each; `values[count]` becomes that of all."""

    def __init__(self, gpu: Gpu, values: GpuArray, count: int) -> None:
        self._gpu, self._chunks = gpu, -(-count // (THREADS * ITEMS))
        self._totals = gpu.array(max(1, self._chunks), np.int32)
        self._arguments = structures()["ScanArguments"](values.address, self._totals.address, count)

    def launch(self) -> None:
        """Three kernels: sums of chunks, sums over these, and both together."""
        for kernel, blocks in (("scan_chunks", self._chunks), ("scan_totals", 1), ("scan_add", self._chunks)):
            self._gpu.launch(kernel, blocks, THREADS, self._arguments)
