"""libsgi, installed and loaded."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from library import ROOT, Library, installed


@pytest.fixture(scope="session")
def prefix() -> Path:
    """Where the shared library is installed."""
    return installed("library")


@pytest.fixture(scope="session")
def library(prefix: Path) -> Library:
    """The shared library, loaded."""
    return Library(prefix / "lib" / "libsgi.so")


@pytest.fixture(scope="session")
def decoder(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """examples/decode.c, compiled as its first lines say."""
    program = tmp_path_factory.mktemp("example") / "decode"
    places = os.environ | {"PKG_CONFIG_PATH": str(prefix / "lib" / "pkgconfig")}
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", "sgi"], env=places, capture_output=True, check=True)
    warnings = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-Wno-missing-field-initializers"]
    command = ["cc", *warnings, ROOT / "examples" / "decode.c", *flags.stdout.decode().split(), "-o", program]
    subprocess.run([*command, f"-Wl,-rpath,{prefix / 'lib'}"], check=True)
    return program
