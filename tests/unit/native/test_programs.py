"""Small programs of native code: loops of the thread pool, which Python does not see, and the functions of vectors."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from children import HANGS
from data_files import ROOT

NATIVE = ROOT / "native"


def said(folder: Path, name: str, *options: object) -> str:
    """What a program of this folder, which is compiled, says on stdout; nothing goes to stderr."""
    compiler = next(filter(shutil.which, [os.environ.get("CXX", "c++"), "g++", "clang++"]))
    source = Path(__file__).with_name(f"{name}.cpp")
    subprocess.run([compiler, f"-I{NATIVE}", source, *options, "-o", folder / name], check=True)
    ran = subprocess.run([folder / name], capture_output=True, text=True, timeout=HANGS)
    assert (ran.returncode, ran.stderr) == (0, "")
    return ran.stdout


def test_loops_within_loops_and_beside_each_other_end(tmp_path: Path) -> None:
    """Every body runs once and exceptions come through; a deadlock, or a loop that waits for its turn while others wait
    for it, would run into the time limit.
    """
    pool = NATIVE / "base" / "thread_pool.cpp"
    assert said(tmp_path, "nested_loops", "-std=c++17", "-pthread", pool) == "1044 of 1044, a reason\n"


def test_functions_of_vectors_are_defined_and_exact_enough(tmp_path: Path) -> None:
    """Under the sanitizer of undefined behaviour."""
    checks = ["-fsanitize=undefined", "-fno-sanitize-recover=all", "-O1", "-ffp-contract=fast", "-Wno-psabi"]
    numbers = map(float, said(tmp_path, "vector_functions", "-std=gnu++17", *checks).split())
    exp_error, log_error, root_error, least, most = numbers
    assert exp_error < 3e-7
    assert log_error < 1e-5
    assert root_error < 3e-7
    assert (least, most) == (0, 1)
