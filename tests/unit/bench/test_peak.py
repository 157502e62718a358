"""Memory of a command: that of all its processes at a time."""

from __future__ import annotations

import subprocess
import sys

import pytest

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
