"""The first minutes of somebody who programs in C: docs/library.md, line by line, in a copy of the sources."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from data_files import ROOT
from PIL import Image

import sgicodec

NEEDED = ("cmake", "cc", "c++", "pkg-config", "bash")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not all(map(shutil.which, NEEDED)), reason=f"needs {', '.join(NEEDED)}"),
]


def told(heading: str) -> str:
    """The first block of commands below a heading."""
    text = (ROOT / "docs" / "library.md").read_text("utf-8").split(f"\n## {heading}\n")[1]
    block = re.search(r"(?:^    .*\n)+", text, re.MULTILINE)
    assert block
    return block[0]


def test_what_the_page_says_draws_a_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From nothing to a picture four times as large, with a home and a path of its own."""
    sources = tmp_path / "sgicodec"
    for name in ("CMakeLists.txt", "pyproject.toml"):
        sources.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, sources)
    for name in (
        "native",
        "include",
        "cmake",
        "programs",
        "examples",
        "sgicodec/bitstream",
        "tests/conformance/golden",
    ):
        shutil.copytree(ROOT / name, sources / name, ignore=shutil.ignore_patterns("__pycache__"))
    place = {"HOME": str(tmp_path), "PATH": f"{Path(sys.executable).parent}:/usr/local/bin:/usr/bin:/bin"}
    started = time.monotonic()
    done = subprocess.run(
        ["bash", "-euc", told("In five minutes")],
        cwd=sources,
        env=place,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    seconds = time.monotonic() - started
    assert done.returncode == 0, done.stdout[-4000:]
    assert "picture     192×128, rgb, 8 bits" in done.stdout
    with sgicodec.open(sources / "tests" / "conformance" / "golden" / "rgb8.sgi") as stream:
        np.testing.assert_array_equal(np.asarray(Image.open(sources / "out.ppm")), stream.read(scale=4))
    with capsys.disabled():
        print(f"\n  C: from sources to the first picture in {seconds:.0f} s")


def test_the_encoder_is_called_as_the_page_says(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "library.md").read_text("utf-8").split("\n## Writing streams\n")[1]
    block = re.search(r"```c\n(.*?)```", text, re.DOTALL)
    assert block
    names = ("spawn", "stdio", "sys/types", "sys/wait", "unistd")
    includes = "".join(f"#include <{name}.h>\n" for name in names)
    (tmp_path / "write.c").write_text(
        f"{includes}extern char **environ;\nint main(void) {{\n{block[1]}return status != 0;\n}}\n"
    )
    subprocess.run(["cc", "-Wall", "-Wextra", "-Werror", "write.c", "-o", "write"], cwd=tmp_path, check=True)
    shutil.copy(ROOT / "tests" / "data" / "pictures" / "basn2c08.png", tmp_path / "photo.png")
    place = {"HOME": str(tmp_path), "PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"}
    done = subprocess.run([tmp_path / "write"], cwd=tmp_path, env=place, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    with sgicodec.open(tmp_path / "photo.sgi") as stream:
        assert (stream.width, stream.height) == (32, 32)
    again = subprocess.run([tmp_path / "write"], cwd=tmp_path, env=place, capture_output=True, text=True)
    assert (again.returncode != 0, again.stdout) == (True, "no stream\n")
