"""The examples of README.md, docs/api.md and docs/plugins.md run, and print what they say."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from command import sgi
from data_files import ROOT, crop

from sgicodec import read, write

README, API, PLUGINS = (ROOT / name for name in ("README.md", "docs/api.md", "docs/plugins.md"))
SECTIONS = ("First file", "Choose the quality", "Many pictures", "Look at a part")
"""Those of README.md whose commands fit a small picture."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with the files that examples read."""
    write(crop("kodim23", np.s_[200:264, 100:196]), tmp_path / "photo.png")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def blocks(page: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", [README, API, PLUGINS], ids=lambda page: page.name)
def test_python_examples(page: Path, folder: Path) -> None:
    """All blocks of a page in turn, as one program; a comment behind print is what it prints."""
    found = blocks(page)
    assert found
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile("\n".join(found), page.name, "exec"), {"__name__": "example"})
    expected = re.findall(r"^ *print\(.*\)  # (.*)$", "\n".join(found), re.MULTILINE)
    assert expected
    lines = printed.getvalue().splitlines()
    assert [line for line in lines if line in expected] == expected


def commands() -> list[str]:
    parts = re.split(r"^## (.*)\n", README.read_text("utf-8"), flags=re.MULTILINE)
    sections = dict(zip(parts[1::2], parts[2::2], strict=True))
    return [
        line for name in SECTIONS for line in re.findall(r"^    (sgi .*?)(?: +#.*)?$", sections[name], re.MULTILINE)
    ]


def test_commands_of_the_readme(folder: Path) -> None:
    """In turn: later ones read what earlier ones wrote."""
    found = commands()
    assert len(found) >= 10
    for command in found:
        arguments = [
            path
            for word in shlex.split(command)[1:]
            for path in (sorted(str(path) for path in Path().glob(word)) if "*" in word else [word])
        ]
        result = sgi(*arguments)
        assert result.exit_code == 0, f"{command}: {result.output}"
    assert read(folder / "eye.png").width == 160
    assert read(folder / "small.png").width == 64
