"""Folders for unfinished files."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from sgicodec.files.scratch import scratch_folder

HOLDS = """
import sys
from pathlib import Path
from sgicodec.files.scratch import scratch_folder
with scratch_folder(Path(sys.argv[1])) as folder:
    (folder / "part").write_bytes(b"much")
    print(folder, flush=True)
    sys.stdin.read()
"""


def test_nothing_is_left(tmp_path: Path) -> None:
    with scratch_folder(tmp_path) as folder:
        (folder / "part").write_bytes(b"much")
        assert folder.parent == tmp_path
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(RuntimeError), scratch_folder(tmp_path) as folder:
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


def test_folders_of_the_living_stay_and_those_of_the_dead_go(tmp_path: Path) -> None:
    (tmp_path / ".sgicodec-other").mkdir()
    command = [sys.executable, "-c", HOLDS, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        theirs = Path(process.stdout.readline().strip())
        with scratch_folder(tmp_path):
            assert (theirs / "part").exists()
        process.kill()
        process.wait()
    assert (theirs / "part").exists()
    with scratch_folder(tmp_path) as ours:
        assert not theirs.exists()
        with scratch_folder(tmp_path) as second:
            assert ours.exists()
            assert second != ours
    assert [path.name for path in tmp_path.iterdir()] == [".sgicodec-other"]
