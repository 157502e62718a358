"""The checkpoint keeps what was finished, and nothing that was not."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from sgicodec import EncodeSettings, open_source
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.plan import stream_plan
from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.encoder.tiles.checkpoint import Checkpoint, fingerprint
from sgicodec.encoder.tiles.store import Version
from sgicodec.errors import OutputExistsError, OutputLockedError, StreamError, UsageError

MARK = bytes(range(32))


def tile(number: int) -> EncodedTile:
    payload = bytes([number]) * (100 + number)
    return EncodedTile(payload, {"colour": 1.5 * number}, number, len(payload), 0.01)


@contextmanager
def opened(path: Path, mark: bytes = MARK, resume: bool = True, force: bool = False) -> Iterator[Checkpoint]:
    checkpoint = Checkpoint(path, resume, force)
    with checkpoint.opened(lambda: mark):
        yield checkpoint


@contextmanager
def until_interrupted(path: Path, resume: bool = False) -> Iterator[Checkpoint]:
    """Presses Ctrl-C at the end of the block."""
    with pytest.raises(KeyboardInterrupt), opened(path, resume=resume) as checkpoint:  # noqa: PT012
        yield checkpoint
        raise KeyboardInterrupt


def interrupted(path: Path, numbers: list[int], resume: bool = False) -> None:
    """Adds tiles, then presses Ctrl-C."""
    with until_interrupted(path, resume) as checkpoint:
        for number in numbers:
            checkpoint.add(Version(number), tile(number))


def test_finished_tiles_are_there_again(tmp_path: Path) -> None:
    path = tmp_path / "part"
    interrupted(path, [2, 0])
    interrupted(path, [1], resume=True)
    with opened(path) as checkpoint:
        assert checkpoint.tiles == {Version(number): replace(tile(number), payload=b"") for number in (0, 1, 2)}
        found = [checkpoint.payload(Version(number)) for number in (0, 1, 2)]
        assert found == [tile(number).payload for number in (0, 1, 2)]
    assert not path.exists()


def test_passes_and_values_are_kept_apart(tmp_path: Path) -> None:
    path = tmp_path / "part"
    with until_interrupted(path) as checkpoint:
        checkpoint.add(Version(1, 0), tile(1))
        assert checkpoint.cached("overview 0", lambda: b"one") == b"one"
        checkpoint.add(Version(1, 3), tile(2))
        assert checkpoint.cached("overview 0", lambda: b"two") == b"one"
        assert checkpoint.cached("overview", lambda: b"\0\1") == b"\0\1"
        assert checkpoint.payload(Version(1, 0)) == tile(1).payload
        checkpoint.add(Version(0, 3), tile(3))
    with opened(path) as checkpoint:
        assert set(checkpoint.tiles) == {(1, 0), (1, 3), (0, 3)}
        found = [checkpoint.payload(Version(*version)) for version in ((1, 0), (1, 3), (0, 3))]
        assert found == [tile(n).payload for n in (1, 2, 3)]
        assert checkpoint.cached("overview 0", lambda: b"two") == b"one"
        assert checkpoint.cached("overview", lambda: b"") == b"\0\1"
        assert checkpoint.cached("overview 1", lambda: b"two") == b"two"


KILLED = """
import os, sys
from dataclasses import replace
from pathlib import Path
from sgicodec.encoder.tiles.checkpoint import Checkpoint
from sgicodec.encoder.tiles.store import Version
from sgicodec.encoder.tile.writing import EncodedTile
checkpoint = Checkpoint(Path(sys.argv[1]))
with checkpoint.opened(lambda: bytes(range(32))):
    for number in range(10**9):
        checkpoint.add(Version(number), EncodedTile(bytes([number % 256]) * 9000, {}, 1, 9000, 0.1))
        print(number, flush=True)
"""


def test_a_kill_at_any_moment_keeps_what_was_added(tmp_path: Path) -> None:
    """Of a process that does nothing but write."""
    path = tmp_path / "part"
    with subprocess.Popen([sys.executable, "-c", KILLED, str(path)], stdout=subprocess.PIPE, text=True) as process:
        while int(process.stdout.readline()) < 20:
            pass
        process.kill()
        added = max([20, *map(int, process.stdout.read().split("\n")[:-1])])
    with opened(path) as checkpoint:
        assert added + 1 <= len(checkpoint.tiles) <= added + 2
        assert checkpoint.payload(Version(added)) == bytes([added % 256]) * 9000
    assert list(tmp_path.iterdir()) == []


def test_a_tile_that_the_disk_changed_is_dropped(tmp_path: Path) -> None:
    path = tmp_path / "part"
    interrupted(path, [0, 1])
    data = bytearray(path.read_bytes())
    data[data.index(tile(1).payload)] ^= 8
    path.write_bytes(data)
    with opened(path) as checkpoint:
        assert set(checkpoint.tiles) == {Version(0)}


def test_a_value_that_the_disk_changed_is_made_again(tmp_path: Path) -> None:
    path = tmp_path / "part"
    overview = bytes(range(200))
    with until_interrupted(path) as checkpoint:
        checkpoint.add(Version(0), tile(0))
        checkpoint.cached("overview", lambda: overview)
    data = bytearray(path.read_bytes())
    data[data.index(overview) + 9] ^= 8
    path.write_bytes(data)
    with opened(path) as checkpoint:
        assert checkpoint.cached("overview", lambda: b"made again") == b"made again"


@pytest.mark.parametrize("resume", [False, True])
def test_without_a_tile_nothing_is_left(tmp_path: Path, resume: bool) -> None:
    interrupted(tmp_path / "part", [], resume=resume)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("damage", ["cut", "header"])
def test_a_damaged_file_is_named(tmp_path: Path, damage: str) -> None:
    path = tmp_path / "part"
    interrupted(path, list(range(20)))
    data = path.read_bytes()
    path.write_bytes({"cut": data[: len(data) // 2], "header": data[:100] + bytes(9) + data[109:]}[damage])
    with pytest.raises(UsageError, match=r"part: this is no sound checkpoint .*; -f starts over"), opened(path):
        pass
    with opened(path, resume=False, force=True) as checkpoint:
        assert not checkpoint.tiles


@pytest.mark.parametrize("resume", [False, True])
def test_a_file_that_is_none_is_left_alone(tmp_path: Path, resume: bool) -> None:
    path = tmp_path / "part"
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE theirs (x)")
    for data in (path.read_bytes(), b"a letter"):
        path.write_bytes(data)
        with pytest.raises(UsageError, match="part is no checkpoint"), opened(path, resume=resume, force=not resume):
            pass
        assert path.read_bytes() == data


def test_two_encodes_cannot_share_one(tmp_path: Path) -> None:
    path = tmp_path / "part"
    for resume, force in ((True, False), (False, True)):
        second = opened(path, resume=resume, force=force)
        with opened(path), pytest.raises(OutputLockedError, match=f"process {os.getpid()} on"), second:
            pass
        assert list(tmp_path.iterdir()) == []


def test_a_tile_that_the_disk_changed_meanwhile(tmp_path: Path) -> None:
    path = tmp_path / "part"
    with opened(path) as checkpoint:
        checkpoint.add(Version(3), tile(3))
        checkpoint._database.execute("UPDATE tiles SET payload = x'00'")
        with pytest.raises(StreamError, match="tile 3 changed on the disk"):
            checkpoint.payload(Version(3))


def test_another_encode_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "part"
    interrupted(path, [0])
    with pytest.raises(UsageError, match="changed"), opened(path, bytes(32)):
        pass
    with pytest.raises(OutputExistsError, match="--resume"), opened(path, resume=False):
        pass
    assert path.exists()
    with opened(path, bytes(32), False, True) as checkpoint:
        assert not checkpoint.tiles


def mark_of(photo: Path, settings: EncodeSettings) -> bytes:
    with open_source(photo) as source:
        windows = windows_of(source)
        return fingerprint(stream_plan(windows.shape, settings), windows.digest())


def test_the_mark_tells_settings_and_sources_apart(photo: Path, settings: EncodeSettings, tmp_path: Path) -> None:
    changed = tmp_path / "changed.png"
    changed.write_bytes(photo.read_bytes() + b"\0")
    marks = {
        mark_of(photo, settings),
        mark_of(changed, settings),
        mark_of(photo, replace(settings, quality=51)),
        mark_of(photo, replace(settings, steps=9)),
        mark_of(photo, replace(settings, seed=1)),
        mark_of(photo, replace(settings, tile=63)),
    }
    assert len(marks) == 6
