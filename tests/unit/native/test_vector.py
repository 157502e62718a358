"""The functions of vectors, driven by a small program of their own under the sanitizer of undefined behaviour."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from children import HANGS

HERE = Path(__file__).resolve().parent
NATIVE = HERE.parents[2] / "native"


def test_functions_are_defined_and_exact_enough(tmp_path: Path) -> None:
    compiler = next(filter(shutil.which, [os.environ.get("CXX", "c++"), "g++", "clang++"]))
    program = tmp_path / "vector_functions"
    checks = ["-fsanitize=undefined", "-fno-sanitize-recover=all", "-O1", "-ffp-contract=fast", "-Wno-psabi"]
    source = HERE / "vector_functions.cpp"
    subprocess.run([compiler, "-std=gnu++17", *checks, f"-I{NATIVE}", source, "-o", program], check=True)
    ran = subprocess.run([program], capture_output=True, text=True, timeout=HANGS)
    assert ran.stderr == ""
    exp_error, log_error, root_error, least, most = map(float, ran.stdout.split())
    assert exp_error < 3e-7
    assert log_error < 1e-5
    assert root_error < 3e-7
    assert (least, most) == (0, 1)
