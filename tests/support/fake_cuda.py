"""A GPU for tests: the kernels compiled for the host behind the driver's interface (fake_cuda.cpp)."""

from __future__ import annotations

import ctypes
import fcntl
import hashlib
import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from threading import get_ident

import pytest

from sgicodec.cuda import sources
from sgicodec.cuda.driver import the_driver
from sgicodec.cuda.gpu import Gpu
from sgicodec.device import Device

ROOT = Path(__file__).resolve().parents[2]
SOURCE = Path(__file__).with_suffix(".cpp")
CHECKS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-O1", "-g1")


@cache
def library() -> Path:
    """The fake libcuda.so.1 below build/, compiled anew where its sources changed; checked where Python itself is."""
    compiler = next(filter(shutil.which, [os.environ.get("CXX", "c++"), "g++", "clang++"]))
    options = CHECKS if "libasan" in os.environ.get("LD_PRELOAD", "") else ("-O2",)
    flags = ["-std=gnu++17", "-ffp-contract=off", "-fPIC", "-shared", "-Wall", "-Wextra", "-Wno-unknown-pragmas"]
    command = [compiler, *flags, *options]
    command += [f"-I{ROOT}", f"-I{ROOT / 'native'}", "-Wl,-soname,libcuda.so.1", str(SOURCE)]
    name = hashlib.sha256((sources.digest(" ".join(command)) + SOURCE.read_text()).encode()).hexdigest()[:16]
    folder = ROOT / "build" / "fake-cuda" / name
    folder.mkdir(parents=True, exist_ok=True)
    with (folder.parent / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "libcuda.so.1").exists():
            made = folder / "new.so"
            subprocess.run([*command, "-o", made], check=True)
            made.rename(folder / "libcuda.so.1")
    return folder / "libcuda.so.1"


@cache
def fake_driver() -> ctypes.CDLL:
    """Takes the driver's place in this process: a library of its name is there already when it is loaded."""
    return ctypes.CDLL(str(library()))


def fake_gpu() -> Gpu:
    """The only GPU of the fake driver, as this thread has it. What it would run is not looked at."""
    return _of_thread(get_ident())


@cache
def _of_thread(thread: int) -> Gpu:
    fake_driver()
    return Gpu(the_driver(), 0, b"for no machine")


@contextmanager
def backwards() -> Iterator[None]:
    """Lets blocks, and threads between two barriers, run from the last to the first."""
    fake_driver().sgi_fake_backwards(1)
    try:
        yield
    finally:
        fake_driver().sgi_fake_backwards(0)


def only_gpu(monkeypatch: pytest.MonkeyPatch) -> Device:
    """A device with the fake GPU, which whoever opens GPU 0 gets."""
    monkeypatch.setattr("sgicodec.cuda.gpu.opened", lambda index: fake_gpu())
    return Device(threads=1, gpu=0)
