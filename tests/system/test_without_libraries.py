"""What works with numpy and the extension alone, and what is said where another library or the extension is missing."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from data_files import GOLDEN, GOLDEN_STREAMS, PICTURES, ROOT

from sgicodec.decoder.stream import open_stream

PICTURE = PICTURES / "hopper_gray.jpg"

WITHOUT = """
import sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {missing!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Missing())
{code}
"""
ALL = ("OpenImageIO", "click", "rich", "torch")


def run(code: str, missing: tuple[str, ...], *arguments: object) -> subprocess.CompletedProcess[str]:
    """Python code in a process of its own that cannot import some libraries."""
    command = [sys.executable, "-c", WITHOUT.format(missing=missing, code=code), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_every_stream_decodes_with_numpy_alone() -> None:
    code = """
import sgicodec
for path in sys.argv[1:]:
    print(f"{sgicodec.open(path).symbol_crc:08x}")
    sgicodec.open(path).picture(size=(9, 7))
"""
    done = run(code, ALL, *GOLDEN_STREAMS)
    assert done.stderr == ""
    expected = []
    for path in GOLDEN_STREAMS:
        with open_stream(path) as stream:
            expected.append(f"{stream.symbol_crc:08x}")
    assert done.stdout.split() == expected


SGI = "from sgicodec.__main__ import main; main()"


@pytest.mark.parametrize(
    ("missing", "arguments", "complaint"),
    [
        ("OpenImageIO", ("encode", PICTURE, "OUT.sgi", "--steps", 1), "reading pictures needs OpenImageIO"),
        ("OpenImageIO", ("decode", GOLDEN / "rgb8.sgi", "OUT.tif"), "writing pictures needs OpenImageIO"),
        ("rich", ("encode", PICTURE, "OUT.sgi", "--steps", 1, "--progress", "on"), "a progress bar needs rich"),
        ("click", ("info", GOLDEN / "rgb8.sgi"), "the command line needs click"),
    ],
)
def test_a_missing_library_is_named(
    tmp_path: Path, missing: str, arguments: tuple[object, ...], complaint: str
) -> None:
    given = [tmp_path / str(one) if str(one).startswith("OUT") else one for one in arguments]
    done = run(SGI, (missing,), *given)
    assert (done.returncode, done.stderr) == (2, f"sgi: {complaint}: pip install {missing}\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("options", ["--steps 4 --tile 32 --bpp 4", "--profile paper --steps 4 --seeds 40"])
def test_every_profile_encodes_without_torch(options: str, tmp_path: Path) -> None:
    """Tests and training alone know it."""
    done = run(SGI, ("torch",), "encode", PICTURE, tmp_path / "out.sgi", *options.split())
    assert done.returncode == 0, done.stderr


def test_streams_are_looked_at_without_the_libraries_of_encodes() -> None:
    done = run(SGI, ("OpenImageIO", "rich", "torch"), "verify", GOLDEN / "rgb8.sgi")
    assert (done.returncode, done.stderr) == (0, "")
    assert "ok" in done.stdout


@pytest.mark.parametrize(
    ("plugin", "missing", "complaint"),
    [
        ("imageio", "imageio", "needs imageio: pip install 'sgicodec[viewers]'"),
        ("numcodecs", "numcodecs", "needs numcodecs: pip install 'sgicodec[zarr]'"),
        ("pillow", "PIL", "the plugin for Pillow needs pillow: pip install pillow"),
        ("xarray", "xarray", "needs xarray: pip install 'sgicodec[arrays]'"),
        ("zarr", "zarr", "needs zarr: pip install 'sgicodec[zarr]'"),
    ],
)
def test_a_plugin_names_its_library(plugin: str, missing: str, complaint: str) -> None:
    assert complaint in run(f"import sgicodec.plugins.{plugin}", (missing,)).stderr


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package's files as a clone of the repository has them that nobody has compiled."""
    folder = tmp_path_factory.mktemp("clone")
    shutil.copytree(ROOT / "sgicodec", folder / "sgicodec", ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    return folder


def run_in(clone: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python in the clone, with the libraries of this environment but without what its .pth files add."""
    libraries = os.pathsep.join([str(clone), str(Path(np.__file__).parents[1])])
    command = [sys.executable, "-S", *arguments]
    return subprocess.run(
        command, cwd=clone, env={**os.environ, "PYTHONPATH": libraries}, capture_output=True, text=True, check=False
    )


def test_the_version_needs_nothing_compiled(clone: Path) -> None:
    result = run_in(clone, "-c", "import sgicodec; print(sgicodec.__version__)")
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.parametrize("use", ["imread('a.sgi')", "encode([[1]])", "open('a.sgi')", "_native"])
def test_use_says_what_to_do(clone: Path, use: str) -> None:
    result = run_in(clone, "-c", f"import sgicodec; sgicodec.{use}")
    assert result.returncode == 1
    line = result.stderr.splitlines()[-1]
    assert line.startswith(f"ImportError: the sgicodec in {clone} is not compiled: run pip install -e .")


def test_the_command_says_it_in_one_line(clone: Path) -> None:
    shutil.copy(GOLDEN / "gray16.sgi", clone)
    result = run_in(clone, "-m", "sgicodec", "info", "gray16.sgi")
    assert result.returncode != 0
    assert "is not compiled: run pip install -e ." in result.stderr
    assert len(result.stderr.splitlines()) == 1
