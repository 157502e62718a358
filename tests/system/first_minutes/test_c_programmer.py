"""The first minutes of somebody who programs in C: docs/library.md, line by line, in a copy of the sources."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable

import numpy as np
import pytest
from data_files import GOLDEN, ROOT
from newcomer import Newcomer
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


def test_what_the_page_says_draws_a_picture(newcomer: Newcomer, reached: Callable[[str], None]) -> None:
    """From nothing to a picture four times as large."""
    sources = newcomer.home / "sgicodec"
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
    printed = newcomer.run("bash", "-euc", f"cd sgicodec\n{told('In five minutes')}")
    reached("the first picture, from sources,")
    assert "picture     192×128, rgb, 8 bits" in printed
    expected = sgicodec.imread(GOLDEN / "rgb8.sgi", scale=4)
    np.testing.assert_array_equal(np.asarray(Image.open(sources / "out.ppm")), expected)


def test_the_encoder_is_called_as_the_page_says(newcomer: Newcomer, reached: Callable[[str], None]) -> None:
    text = (ROOT / "docs" / "library.md").read_text("utf-8").split("\n## Writing streams\n")[1]
    block = re.search(r"```c\n(.*?)```", text, re.DOTALL)
    assert block
    names = ("spawn", "stdio", "sys/types", "sys/wait", "unistd")
    includes = "".join(f"#include <{name}.h>\n" for name in names)
    newcomer.install()
    (newcomer.home / "write.c").write_text(
        f"{includes}extern char **environ;\nint main(void) {{\n{block[1]}return status != 0;\n}}\n"
    )
    newcomer.run("cc", "-Wall", "-Wextra", "-Werror", "write.c", "-o", "write")
    shutil.copy(ROOT / "tests" / "data" / "pictures" / "basn2c08.png", newcomer.home / "photo.png")
    assert newcomer.run("./write") == ""
    reached("a stream by a program in C")
    assert sgicodec.imread(newcomer.home / "photo.sgi").shape == (32, 32, 3)
    assert newcomer.run("bash", "-c", "! ./write 2>errors") == "no stream\n"
