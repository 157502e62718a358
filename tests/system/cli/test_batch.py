"""Many files by one command: folders, names, files that exist already, progress."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
from command import done, sgi

from sgicodec import read, write


@pytest.fixture
def tree(picture: Path, tmp_path: Path) -> Path:
    """Pictures in a folder and its subfolders, among other files."""
    folder = tmp_path / "photos"
    (folder / "2025" / "may").mkdir(parents=True)
    for name in ("a.png", "2025/a.png", "2025/may/b.png", "2025/.hidden.png"):
        shutil.copy(picture, folder / name)
    write(read(picture), folder / "2025" / "may" / "b.tif")
    (folder / "notes.txt").write_text("no picture")
    return folder


def files(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_folders_keep_their_subfolders(tree: Path, tmp_path: Path) -> None:
    out = tmp_path / "streams"
    result = done("encode", "-r", tree, "--output-dir", out, "--steps", 1)
    assert files(out) == ["2025/a.sgi", "2025/may/b.png.sgi", "2025/may/b.tif.sgi", "a.sgi"]
    size = sum(path.stat().st_size for path in out.rglob("*.sgi"))
    assert result.stdout.splitlines()[-1] == f"4 of 4 files encoded, {size:,} bytes"
    back = tmp_path / "back"
    (out / "README").write_text("no stream")
    done("decode", "-r", out, "--output-dir", back)
    assert files(back) == ["2025/a.png", "2025/may/b.png.png", "2025/may/b.tif.png", "a.png"]


def test_what_is_there_is_left_out(tree: Path, tmp_path: Path) -> None:
    out = tmp_path / "streams"
    out.mkdir()
    (out / "a.sgi").write_bytes(b"mine")
    options = ("-r", tree, "--output-dir", out, "--steps", 1)
    summary = json.loads(done("encode", *options, "--skip-existing", "--json").stdout.splitlines()[-1])
    assert {name: summary[name] for name in ("files", "encoded", "skipped", "failed")} == {
        **{"files": 4, "encoded": 3, "skipped": 1, "failed": 0}
    }
    assert (out / "a.sgi").read_bytes() == b"mine"
    again = sgi("encode", *options, "--skip-existing")
    assert (again.exit_code, again.stdout) == (0, "0 of 4 files encoded, 4 there already, 0 bytes\n")
    assert sgi("encode", *options).stderr.count("exists; give -f") == 4


def test_equal_names_are_one_line_and_stop_nothing(picture: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    for name in ("scene.png", "last.png"):
        shutil.copy(picture, other / name)
    out = tmp_path / "out"
    result = sgi("encode", picture, other / "scene.png", other / "last.png", "--output-dir", out, "--steps", 1)
    assert result.exit_code == 1
    assert files(out) == ["last.sgi", "scene.png.sgi"]
    first, last = result.stderr.splitlines()
    assert first == f"sgi: {other / 'scene.png'}: {out / 'scene.png.sgi'} is that of {picture}"
    assert last == "sgi: 1 of 3 files failed"


def test_what_cannot_be_looked_into_fails_alone(tree: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    denied = {tree / "a.png", tree / "2025" / "may"}
    opened, listed = Path.open, os.scandir

    def refuse(path: object) -> None:
        if Path(str(path)) in denied:
            raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "open", lambda path, *rest, **more: refuse(path) or opened(path, *rest, **more))
    monkeypatch.setattr(os, "scandir", lambda path=".": refuse(path) or listed(path))
    result = sgi("encode", "-r", tree, "--output-dir", tmp_path / "streams", "--steps", 1, "--quiet")
    failures = [f"sgi: {path}: Permission denied" for path in sorted(denied, reverse=True)]
    assert result.stderr.splitlines() == [*failures, "sgi: 2 of 3 files failed"]
    assert (result.exit_code, files(tmp_path / "streams")) == (1, ["2025/a.sgi"])
