"""Builds GDAL's driver below build/ and runs GDAL's own programs, which load it."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from library import ROOT, installed

NEEDS_GDAL = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not all(map(shutil.which, ("cmake", "c++", "gdal-config", "gdalinfo", "gdal_translate"))),
        reason="needs cmake, a C++ compiler, and GDAL with its headers and programs",
    ),
]

Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def gdal() -> Run:
    """Runs a program of GDAL that knows the driver, which one process at a time compiles where its sources changed."""
    prefix, build = installed("library"), ROOT / "build" / "gdal"
    build.mkdir(exist_ok=True)
    configure = ["cmake", "-S", ROOT / "gdal", "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}"]
    with (build / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for command in ([*configure, "-DCMAKE_BUILD_TYPE=Release"], ["cmake", "--build", build]):
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            assert done.returncode == 0, done.stdout
    places = os.environ | {"GDAL_DRIVER_PATH": str(build), "GDAL_PAM_ENABLED": "NO"}

    def run(*command: object, fails: bool = False) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(list(map(str, command)), env=places, capture_output=True, text=True)
        assert (done.returncode != 0) == fails, done.stderr
        return done

    return run


def info(gdal: Run, path: object, *options: object) -> dict[str, Any]:
    return json.loads(gdal("gdalinfo", "-json", path, *options).stdout)


def pixels(gdal: Run, path: object, out: Path, *options: object) -> np.ndarray:
    """What gdal_translate makes of it."""
    import tifffile

    gdal("gdal_translate", "-q", *options, path, out)
    return tifffile.imread(out)
