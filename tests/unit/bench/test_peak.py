"""Memory of a command: that of all its processes at a time."""

from __future__ import annotations

import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from sgicodec.bench import launch
from sgicodec.bench.peak import family, together

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="no other system tells what processes share")

HOLD = "held = bytearray(100 << 20); held[::4096] = b'x' * len(held[::4096]); print('held', flush=True); input()"
PARENT = f"""
import subprocess, sys
for _ in range(int(sys.argv[1])):
    child = subprocess.Popen([sys.executable, "-c", {HOLD!r}], stdout=subprocess.PIPE)
    child.stdout.readline()
print("ready", flush=True)
input()
"""


@pytest.mark.parametrize("children", [0, 1, 2])
def test_processes_are_added_up(children: int) -> None:
    command = [sys.executable, "-c", PARENT, str(children)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        parent.stdout.readline()
        assert len(list(family(parent.pid))) == 1 + children
        held = together(parent.pid)
        parent.communicate(b"\n\n\n")
    assert 100 * children <= held <= 140 * children


def test_a_launch_looks_while_the_command_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And takes the most that it saw."""
    seen = tmp_path / "seen"
    sizes = iter([7.0, 90.0, 8.0])

    def looked(pid: int) -> float:
        size = next(sizes, None)
        if size is None:
            seen.touch()
        return size or 0.0

    def peak(path: str) -> dict[str, Any]:
        assert Path(path).name == "peak.py"
        return {"together": looked}

    monkeypatch.setattr(runpy, "run_path", peak)
    wait = f"import pathlib\nwhile not pathlib.Path({str(seen)!r}).exists(): pass\nraise SystemExit(3)"
    assert launch.run([sys.executable, "-c", wait]) == (3, 90.0)
