"""Where torch is not installed every profile encodes: tests and training alone know it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sgicodec import Picture, write

NOWHERE = """
import sys
class Nowhere:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "torch":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Nowhere())
"""


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pictures") / "noise.png"
    write(Picture(np.random.default_rng(1).integers(0, 256, (48, 64, 3), np.uint8), "rgb", (0, 255)), path)
    return path


def run(code: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def sgi(blocker: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    """`sgi` with these arguments, where torch cannot be imported."""
    return run(f"{blocker}\nfrom sgicodec.cli.main import main\nmain()", *arguments)


@pytest.mark.parametrize("options", ["--steps 4 --tile 32 --bpp 4", "--profile paper --steps 4 --seeds 40"])
def test_every_profile_encodes(options: str, picture: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.sgi"
    done = sgi(NOWHERE, "encode", picture, target, *options.split())
    assert done.returncode == 0, done.stderr
    assert sgi(NOWHERE, "verify", target).returncode == 0
