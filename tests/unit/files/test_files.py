"""Files that appear whole or not at all, folders for unfinished ones, and locks: one writer at a time, whoever ends."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest
from children import HANGS

from sgicodec.errors import OutputLockedError
from sgicodec.files.lock import locked
from sgicodec.files.scratch import scratch_folder
from sgicodec.files.whole import keep_access, whole_file


def write_whole(path: Path, data: bytes) -> None:
    with whole_file(path) as file:
        file.write(data)


@pytest.mark.parametrize("step", ["fsync", "replace"])
@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_failure_keeps_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str, failure: BaseException
) -> None:
    target = tmp_path / "a.bin"
    target.write_bytes(b"old")

    monkeypatch.setattr(os, step, Mock(side_effect=failure))
    with pytest.raises(type(failure)):
        write_whole(target, b"new")
    assert target.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.bin"]


def test_permissions_follow_the_umask(tmp_path: Path) -> None:
    old = os.umask(0o027)
    try:
        write_whole(tmp_path / "a.bin", b"x")
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "a.bin").stat().st_mode) == 0o640


def test_permissions_are_those_of_the_old_file(tmp_path: Path) -> None:
    target = tmp_path / "a.bin"
    target.write_bytes(b"private")
    target.chmod(0o600)
    write_whole(target, b"x")
    assert stat.S_IMODE(target.stat().st_mode) == 0o600


def test_who_is_no_owner_of_a_group_shuts_it_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rather than let another one in."""
    old, new = tmp_path / "old", tmp_path / "new"
    for path in (old, new):
        path.touch(0o640)
    old.chmod(0o640)
    keep_access(old, new)
    assert stat.S_IMODE(new.stat().st_mode) == 0o640
    monkeypatch.setattr(Path, "stat", lambda path: Mock(st_gid=1 + (path == old), st_mode=0o100640))
    monkeypatch.setattr(os, "chown", Mock(side_effect=PermissionError))
    keep_access(old, new)
    assert stat.S_IMODE(os.stat(new).st_mode) == 0o600


@pytest.mark.parametrize("how", ["link", "letter"])
def test_what_is_no_lock_is_left_alone(tmp_path: Path, how: str) -> None:
    letter, lock = tmp_path / "letter", tmp_path / ".a.sgi.lock"
    letter.write_text("dear all")
    lock.symlink_to(letter) if how == "link" else letter.rename(lock)
    with locked(tmp_path / "a.sgi"):
        pass
    assert lock.read_text() == "dear all"


def test_follows_links(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "folder" / "real.bin")
    write_whole(link, b"x")
    assert link.is_symlink()
    assert (tmp_path / "folder" / "real.bin").read_bytes() == b"x"


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


HOLDER = """
import sys
from pathlib import Path
from sgicodec.files.lock import locked
with locked(Path({path!r})):
    print("held", flush=True)
    sys.stdin.read()
"""


def test_another_process_is_named(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    out = tmp_path / "out.sgi"
    code = HOLDER.format(path=str(out))
    environment = os.environ | {"PYTHONPATH": ":".join(sys.path)}
    holder = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
    )
    assert holder.stdout.readline() == "held\n"
    text = rf"out.sgi is being written by process {holder.pid} on .*, since "
    with pytest.raises(OutputLockedError, match=text), locked(out):
        pass
    holder.kill()
    holder.communicate(timeout=HANGS)
    with locked(out):  # what was killed holds nothing, though its lock's file is there
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_has_locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """That are let go of, though nobody can be named in them."""
    pytest.importorskip("fcntl")
    out = tmp_path / "out.sgi"

    monkeypatch.setattr(os, "write", Mock(side_effect=OSError(28, "No space left on device")))
    for _ in range(2):
        with locked(out), pytest.raises(OutputLockedError, match="by another encode"), locked(out):
            pass
        assert os.listdir(tmp_path) == []


def test_links_share_a_lock(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    (tmp_path / "link").symlink_to(tmp_path / "out.sgi")
    with locked(tmp_path / "out.sgi"), pytest.raises(OutputLockedError), locked(tmp_path / "link"):
        pass
