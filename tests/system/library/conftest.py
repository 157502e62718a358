"""libsgi, installed and loaded."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from library import ROOT, Library, installed

EXAMPLES = ROOT / "examples"


@pytest.fixture(scope="session")
def prefix() -> Path:
    """Where the shared library is installed."""
    return installed("library")


@pytest.fixture(scope="session")
def library(prefix: Path) -> Library:
    """The shared library, loaded."""
    return Library(prefix / "lib" / "libsgi.so")


@pytest.fixture(scope="session")
def example(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Compiles a program of examples/ as its first lines say, with objects of others."""
    folder, places = tmp_path_factory.mktemp("examples"), {"PKG_CONFIG_PATH": str(prefix / "lib" / "pkgconfig")}
    flags = subprocess.run(
        ["pkg-config", "--cflags", "--libs", "sgi"], env=os.environ | places, capture_output=True, check=True, text=True
    ).stdout.split()
    warnings = ["-Wall", "-Wextra", "-Werror"]

    def compiled(name: str, *others: str) -> Path:
        program = folder / "-".join([name, *others])
        objects = [program.with_suffix(".o")]
        subprocess.run(
            ["cc", "-std=c99", *warnings, "-c", EXAMPLES / f"{name}.c", *flags, "-o", objects[0]], check=True
        )
        for other in others:
            objects.append(folder / f"{other}.o")
            subprocess.run(["c++", *warnings, "-c", EXAMPLES / f"{other}.cpp", "-o", objects[-1]], check=True)
        linker = "c++" if others else "cc"
        subprocess.run([linker, *objects, *flags, f"-Wl,-rpath,{prefix / 'lib'}", "-o", program], check=True)
        return program

    return compiled


@pytest.fixture(scope="session")
def decoder(example: Callable[..., Path]) -> Path:
    """examples/decode.c"""
    return example("decode")
