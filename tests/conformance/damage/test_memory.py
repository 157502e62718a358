"""A picture that memory does not suffice for ends in an error, not in an abort, whichever thread runs out."""

from __future__ import annotations

import pytest
from little_memory import printed

pytest.importorskip("resource")

HUNGRY = """
import resource
import numpy as np
from sgicodec.device import Device
from sgicodec.raster.cpu import NativeRasterizer
count, memory = 200_000, 1 << 29
means = np.full((count, 2), 200, np.float32)
shapes = np.tile(np.float32([1e6, 0, 1e6]), (count, 1))
colours = np.ones((count, 1), np.float32)
raster = NativeRasterizer(Device({threads}), most_pairs=1 << 40)
raster.forward(means[:9], shapes[:9], colours[:9], 1600, 800)
resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
try:
    raster.forward(means, shapes, colours, 1600, 800)
except MemoryError:
    print("too little memory")
print(raster.forward(means[:9], shapes[:9], colours[:9], 1600, 800).max().round())
"""


@pytest.mark.parametrize("threads", [1, 2])
def test_memory_runs_out(threads: int) -> None:
    assert printed(HUNGRY.format(threads=threads)) == "too little memory\n9.0\n"
