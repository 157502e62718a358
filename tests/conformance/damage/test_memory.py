"""A picture that memory does not suffice for ends in an error, not in an abort, whichever thread runs out."""

from __future__ import annotations

import subprocess
import sys

import pytest
from children import HANGS
from sanitizer import needs_plain_memory

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
    needs_plain_memory()
    code = HUNGRY.format(threads=threads)
    environment = {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": ":".join(sys.path)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=HANGS, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "too little memory\n9.0\n"
