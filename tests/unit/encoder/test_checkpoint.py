"""The journal keeps what was finished, and nothing that was not."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from sgicodec import EncodeSettings
from sgicodec.encoder.checkpoint import Journal, fingerprint, opened_journal
from sgicodec.encoder.interfaces import Version
from sgicodec.encoder.out_of_core import plan_of
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile_work import EncodedTile
from sgicodec.errors import OutputExistsError, UsageError
from sgicodec.image import open_source

MARK = bytes(range(32))


def tile(number: int) -> EncodedTile:
    payload = bytes([number]) * (100 + number)
    return EncodedTile(payload, {"colour": 1.5 * number}, number, 0.25, 300, 0.5, len(payload), 0.01)


def interrupted(path: Path, numbers: list[int], mark: bytes = MARK, resume: bool = False) -> None:
    """Adds tiles, then presses Ctrl-C."""

    def work() -> None:
        with opened_journal(path, mark, resume, False) as journal:
            for number in numbers:
                journal.add(Version(number), tile(number))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work()


def test_finished_tiles_are_there_again(tmp_path: Path) -> None:
    path = tmp_path / "part"
    interrupted(path, [2, 0])
    interrupted(path, [1], resume=True)
    with opened_journal(path, MARK, True, False) as journal:
        assert journal.tiles == {Version(number): replace(tile(number), payload=b"") for number in (0, 1, 2)}
        assert [journal.payload(Version(number)) for number in (0, 1, 2)] == [
            tile(number).payload for number in (0, 1, 2)
        ]
    assert not path.exists()


def test_rounds_and_numbers_are_kept_apart(tmp_path: Path) -> None:
    path = tmp_path / "part"

    def work() -> None:
        with opened_journal(path, MARK, False, False) as journal:
            journal.add(Version(1, 0), tile(1))
            assert journal.remembered("lmbda 0", lambda: 0.1 + 0.2) == 0.1 + 0.2
            journal.add(Version(1, 3), tile(2))
            assert journal.remembered("lmbda 0", lambda: 7.0) == 0.1 + 0.2
            assert journal.payload(Version(1, 0)) == tile(1).payload
            journal.add(Version(0, 3), tile(3))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work()
    with opened_journal(path, MARK, True, False) as journal:
        assert set(journal.tiles) == {(1, 0), (1, 3), (0, 3)}
        assert [journal.payload(version) for version in journal.tiles] == [tile(n).payload for n in (1, 2, 3)]
        assert journal.remembered("lmbda 0", lambda: 7.0) == 0.1 + 0.2
        assert journal.remembered("lmbda 1", lambda: 7.0) == 7.0


@pytest.mark.parametrize("lost", [1, 60, 130, 250])
def test_what_a_kill_cut_short_is_dropped(tmp_path: Path, lost: int) -> None:
    path = tmp_path / "part"
    interrupted(path, [0, 1, 2])
    data = path.read_bytes()
    path.write_bytes(data[:-lost])
    interrupted(path, [7], resume=True)
    with opened_journal(path, MARK, True, False) as journal:
        assert {0, 7} <= {version.tile for version in journal.tiles} <= {0, 1, 7}
        assert journal.payload(Version(7)) == tile(7).payload


def test_a_damaged_record_is_dropped(tmp_path: Path) -> None:
    path = tmp_path / "part"
    interrupted(path, [0, 1])
    data = bytearray(path.read_bytes())
    data[-5] ^= 1
    path.write_bytes(data)
    with opened_journal(path, MARK, True, False) as journal:
        assert set(journal.tiles) == {Version(0)}


def test_tiles_are_on_disk_before_add_returns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []
    real = os.fsync
    monkeypatch.setattr(os, "fsync", lambda number: (synced.append(os.fstat(number).st_size), real(number))[1])
    with (tmp_path / "part").open("w+b") as file:
        journal = Journal(file, MARK)
        journal.add(Version(0), tile(0))
        assert synced[-1] == file.tell() > 100


def test_another_encode_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "part"
    interrupted(path, [0])
    with pytest.raises(UsageError, match="changed"), opened_journal(path, bytes(32), True, False):
        pass
    with pytest.raises(OutputExistsError, match="--resume"), opened_journal(path, MARK, False, False):
        pass
    assert path.exists()
    with opened_journal(path, bytes(32), False, True) as journal:
        assert not journal.tiles


def plan_with(photo: Path, settings: EncodeSettings) -> Plan:
    with open_source(photo) as source:
        return plan_of(source, settings)


def test_the_mark_tells_settings_and_sources_apart(photo: Path, settings: EncodeSettings, tmp_path: Path) -> None:
    plan = plan_with(photo, settings)
    changed = tmp_path / "changed.png"
    changed.write_bytes(photo.read_bytes() + b"\0")
    marks = {
        fingerprint(plan, photo),
        fingerprint(plan, changed),
        fingerprint(plan_with(photo, replace(settings, quality=51)), photo),
        fingerprint(plan_with(photo, replace(settings, steps=9)), photo),
        fingerprint(plan_with(photo, replace(settings, seed=1)), photo),
        fingerprint(plan_with(photo, replace(settings, tile=63)), photo),
    }
    assert len(marks) == 6


def test_another_time_limit_goes_on_where_one_was_the_limit(photo: Path, settings: EncodeSettings) -> None:
    settings = replace(settings, steps=None)
    marks = [fingerprint(plan_with(photo, replace(settings, time_limit=limit)), photo) for limit in (3.0, 40.0, None)]
    assert marks[0] == marks[1] != marks[2]
    other = fingerprint(plan_with(photo, replace(settings, time_limit=3.0, quality=51)), photo)
    assert other != marks[0]
