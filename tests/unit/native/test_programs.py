"""Native code that Python does not see: the thread pool, functions of vectors, libsgi's interface."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from children import HANGS
from data_files import ROOT

NATIVE = ROOT / "native"


def compiled(*options: object) -> None:
    """Runs the compiler; it must find nothing wrong."""
    compiler = next(filter(shutil.which, [os.environ.get("CXX", "c++"), "g++", "clang++"]))
    subprocess.run([compiler, f"-I{NATIVE}", *options], check=True)


def said(folder: Path, name: str, *options: object) -> str:
    """What a program of this folder, which is compiled, says on stdout; nothing goes to stderr."""
    compiled(Path(__file__).with_name(f"{name}.cpp"), *options, "-o", folder / name)
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


def test_the_interface_of_libsgi_suits_the_decoder() -> None:
    """Slow tests alone build and call it; here it is only read by a compiler."""
    named = [f"-I{ROOT / 'include'}", "-DSGI_BUILDING=1", '-DSGI_VERSION="0"']
    compiled("-std=gnu++17", "-fsyntax-only", "-Wno-psabi", *named, *sorted((NATIVE / "capi").glob("*.cpp")))
