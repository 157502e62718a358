"""Locks: one writer of a file at a time, whoever ends."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from children import HANGS

from sgicodec.errors import OutputLockedError
from sgicodec.files.lock import locked

pytest.importorskip("fcntl")

HOLDER = """
import sys
from pathlib import Path
from sgicodec.files.lock import locked
with locked(Path({path!r})):
    print("held", flush=True)
    sys.stdin.read()
"""


def test_another_process_is_named(tmp_path: Path) -> None:
    out = tmp_path / "out.sgi"
    code = HOLDER.format(path=str(out))
    environment = os.environ | {"PYTHONPATH": ":".join(sys.path)}
    holder = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
    )
    assert holder.stdout is not None
    assert holder.stdout.readline() == "held\n"
    text = rf"out.sgi is being written by process {holder.pid} on .*, since "
    with pytest.raises(OutputLockedError, match=text), locked(out):
        pass
    holder.kill()
    holder.communicate(timeout=HANGS)
    with locked(out):  # what was killed holds nothing, though its lock's file is there
        pass
    assert list(tmp_path.iterdir()) == []


def test_links_share_a_lock(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "out.sgi")
    with locked(tmp_path / "out.sgi"), pytest.raises(OutputLockedError), locked(tmp_path / "link"):
        pass
