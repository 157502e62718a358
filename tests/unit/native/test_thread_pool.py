"""The native thread pool, driven by a small program of its own: Python sees no loops."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from children import HANGS

HERE = Path(__file__).resolve().parent
NATIVE = HERE.parents[2] / "native"


def test_loops_within_loops_and_beside_each_other_end(tmp_path: Path) -> None:
    """Every body runs once and exceptions come through; a deadlock, or a loop that waits for its turn while others wait
    for it, would run into the time limit.
    """
    compiler = next(filter(shutil.which, [os.environ.get("CXX", "c++"), "g++", "clang++"]))
    sources = [HERE / "nested_loops.cpp", NATIVE / "base" / "thread_pool.cpp"]
    program = tmp_path / "nested_loops"
    subprocess.run([compiler, "-std=c++17", "-pthread", f"-I{NATIVE}", *sources, "-o", program], check=True)
    ran = subprocess.run([program], capture_output=True, text=True, timeout=HANGS, check=True)
    assert ran.stdout == "1044 of 1044, a reason\n"
