"""Every program of tools/ runs from the repository's root, and its README names it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).parents[3] / "tools"
PROGRAMS = sorted(path.stem for path in TOOLS.glob("*.py") if "__main__" in path.read_text("utf-8"))

HELP = """
import contextlib, io, runpy, sys
for name in sys.argv[1:]:
    sys.argv, text = [name, "--help"], io.StringIO()
    with contextlib.redirect_stdout(text):
        try:
            runpy.run_module(f"tools.{name}", run_name="__main__")
        except SystemExit as end:
            status = end.code
    print(name, status, *text.getvalue().lower().split()[:1])
"""
"""Prints for each program what its help begins with. One process for all, for torch takes seconds to import."""


def test_all_have_help() -> None:
    pytest.importorskip("mpmath")
    pytest.importorskip("torch")
    command = [sys.executable, "-c", HELP, *PROGRAMS]
    done = subprocess.run(command, cwd=TOOLS.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [f"{name} 0 usage:" for name in PROGRAMS]


def test_the_readme_names_all() -> None:
    text = (TOOLS / "README.md").read_text("utf-8")
    assert [name for name in PROGRAMS if f"python -m tools.{name} " not in text] == []
    assert len(PROGRAMS) >= 3
