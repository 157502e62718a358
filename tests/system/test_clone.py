"""A clone of the repository that nobody has compiled."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from data_files import ROOT


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package's files as a clone has them."""
    folder = tmp_path_factory.mktemp("clone")
    shutil.copytree(ROOT / "sgicodec", folder / "sgicodec", ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    return folder


def run(clone: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python in the clone, with the libraries of this environment but without what its .pth files add."""
    libraries = os.pathsep.join([str(clone), str(Path(np.__file__).parents[1])])
    command = [sys.executable, "-S", *arguments]
    return subprocess.run(
        command, cwd=clone, env={**os.environ, "PYTHONPATH": libraries}, capture_output=True, text=True, check=False
    )


def test_the_version_needs_nothing_compiled(clone: Path) -> None:
    result = run(clone, "-c", "import sgicodec; print(sgicodec.__version__)")
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.parametrize("use", ["imread('a.sgi')", "encode([[1]])", "open('a.sgi')", "_native"])
def test_use_says_what_to_do(clone: Path, use: str) -> None:
    result = run(clone, "-c", f"import sgicodec; sgicodec.{use}")
    assert result.returncode == 1
    line = result.stderr.splitlines()[-1]
    assert line.startswith(f"ImportError: the sgicodec in {clone} is not compiled: run pip install -e .")


def test_the_command_says_it_in_one_line(clone: Path) -> None:
    shutil.copy(ROOT / "tests" / "conformance" / "golden" / "gray16.sgi", clone)
    result = run(clone, "-m", "sgicodec", "info", "gray16.sgi")
    assert result.returncode != 0
    assert "is not compiled: run pip install -e ." in result.stderr
    assert len(result.stderr.splitlines()) == 1
