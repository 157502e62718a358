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


def test_a_lock_that_goes_while_it_is_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its holder ended between our opening and our locking: that file is no lock any more."""
    beside, real, opened = tmp_path / ".out.sgi.lock", os.open, []

    def open_late(path: Path, *options: int) -> int:
        file = real(path, *options)
        if not opened:
            path.unlink()
        opened.append(path)
        return file

    monkeypatch.setattr(os, "open", open_late)
    with locked(tmp_path / "out.sgi"):
        assert opened == [beside, beside]
        assert beside.exists()


@pytest.mark.parametrize("name", ["x" * 254, "missing/out.sgi"])
def test_what_cannot_be_locked_is_left_to_writing(tmp_path: Path, name: str) -> None:
    with locked(tmp_path / name), locked(tmp_path / name):
        pass


def test_devices_have_none() -> None:
    with locked(Path("/dev/null")), locked(Path("/dev/null")):
        pass
