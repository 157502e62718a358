"""Every program of tools/ runs from the repository's root, and its README names it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).parents[3] / "tools"
PROGRAMS = sorted(path.stem for path in TOOLS.glob("*.py") if "__main__" in path.read_text("utf-8"))


@pytest.mark.parametrize("name", PROGRAMS)
def test_it_has_help(name: str) -> None:
    pytest.importorskip("mpmath" if name == "make_tables" else "torch")
    command = [sys.executable, "-m", f"tools.{name}", "--help"]
    done = subprocess.run(command, cwd=TOOLS.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.lower().startswith("usage:")


def test_the_readme_names_all() -> None:
    text = (TOOLS / "README.md").read_text("utf-8")
    assert [name for name in PROGRAMS if f"python -m tools.{name} " not in text] == []
    assert len(PROGRAMS) >= 6
