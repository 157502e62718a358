"""Files of commands: many by one, folders, names, files that exist already; which pictures an encode takes."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest
from command import done, refused, sgi
from data_files import PICTURES

from sgicodec import imread, read, write


@pytest.fixture
def tree(picture: Path, tmp_path: Path) -> Path:
    """Pictures in a folder and its subfolders, among other files."""
    folder = tmp_path / "photos"
    (folder / "2025" / "may").mkdir(parents=True)
    (folder / ".thumbnails").mkdir()
    for name in ("a.png", "2025/a.png", "2025/may/b.png", "2025/.hidden.png", ".thumbnails/a.png"):
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
    one = done("encode", tree / "a.png", out / "a.sgi", "--skip-existing", "--json").stdout
    assert json.loads(one)["skipped"] is True


def test_a_picture_called_as_its_stream_is_not_done(tmp_path: Path) -> None:
    shutil.copy(PICTURES / "hopper.sgi", tmp_path)  # of Silicon Graphics
    found = sgi("encode", "-r", tmp_path, "--skip-existing")
    assert (found.exit_code, found.stdout) == (1, "0 of 1 files encoded, 0 bytes\n")
    assert "both input and output" in found.stderr


@pytest.mark.parametrize("name", ["x.sgi.part", ".x.sgi.lock", "x.sgi.part-journal"])
def test_what_is_written_beside_out_is_not_in(picture: Path, name: str) -> None:
    source = picture.rename(picture.with_name(name))
    assert f"{source} is both input" in refused(2, "encode", source, source.with_name("x.sgi"), "--tile", 32, "-f")
    assert source.exists()


def test_one_without_memory_stops_nothing(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sgicodec.encoder.pipeline.windows_of", Mock(side_effect=MemoryError))
    found = sgi("encode", "-r", tree, "--steps", 1)
    assert (found.exit_code, found.stderr.count(": there is not enough memory\n")) == (1, 4)


def test_names_do_not_steer_a_terminal(stream: Path) -> None:
    odd = stream.rename(stream.with_name("a\n\x1b[31mb.sgi"))
    assert done("verify", odd).stdout.startswith(f"{stream.parent}/a\ufffd\ufffd[31mb.sgi: ok")


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
    broken = tree / "2025" / "link.png"
    broken.symlink_to("gone.png")
    opened, listed = Path.open, os.scandir

    def refuse(path: object) -> None:
        if Path(str(path)) in denied:
            raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "open", lambda path, *rest, **more: refuse(path) or opened(path, *rest, **more))
    monkeypatch.setattr(os, "scandir", lambda path=".": refuse(path) or listed(path))
    result = sgi("encode", "-r", tree, "--output-dir", tmp_path / "streams", "--steps", 1, "--quiet")
    failures = [f"sgi: {path}: Permission denied" for path in sorted(denied, reverse=True)]
    failures.insert(1, f"sgi: {broken}: No such file or directory")
    assert result.stderr.splitlines() == [*failures, "sgi: 3 of 4 files failed"]
    assert (result.exit_code, files(tmp_path / "streams")) == (1, ["2025/a.sgi"])


def test_an_existing_output_stays(picture: Path, asked: dict[str, Any]) -> None:
    target = picture.with_suffix(".sgi")
    target.write_bytes(b"old")
    assert refused(6, "encode", picture, target) == f"sgi: {target} exists; give -f to overwrite it\n"
    assert target.read_bytes() == b"old"
    assert asked == {}


@pytest.mark.parametrize("old", [b"old", b"", b"\x89SGX not ours"])
@pytest.mark.parametrize("more", [[], ["-f"], ["-f", "-r"]])
def test_a_default_out_replaces_streams_alone(picture: Path, old: bytes, more: list[str]) -> None:
    target = picture.with_suffix(".sgi")
    target.write_bytes(old)
    result = sgi("encode", picture, "--steps", 2, *more)
    assert result.exit_code == (1 if "-r" in more else 6)
    assert "exists, and no default OUT replaces it; name OUT or --output-dir, with -f" in result.stderr
    assert target.read_bytes() == old


@pytest.mark.parametrize("more", [[], ["-r"]])
def test_a_stream_beside_its_picture_is_replaced_with_force(picture: Path, stream: Path, more: list[str]) -> None:
    before = stream.read_bytes()
    assert sgi("encode", picture, "--steps", 2, *more).exit_code == (1 if more else 6)
    assert stream.read_bytes() == before
    done("encode", picture, "-f", "--steps", 2, *more)
    assert stream.read_bytes() != before


def test_the_input_is_never_the_output(picture: Path) -> None:
    before = picture.read_bytes()
    link = picture.with_name("link.png")
    link.symlink_to(picture)
    for target in (picture, link):
        assert "both input and output" in refused(2, "encode", picture, target, "-f")
    assert picture.read_bytes() == before


@pytest.mark.parametrize("name", ["truncated_jpeg.jpg", "xcsn0g01.png", "README.md", "missing.png", "."])
def test_unreadable_pictures(tmp_path: Path, name: str) -> None:
    assert refused(3, "encode", PICTURES / name, tmp_path / "out.sgi").startswith(f"sgi: {PICTURES / name}: ")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("more", [[], ["-f"]])
def test_a_picture_that_was_matched_as_out_is_never_overwritten(picture: Path, more: list[str]) -> None:
    """`sgi encode *.png` in a folder of two pictures."""
    second = picture.with_name("second.png")
    second.write_bytes(picture.read_bytes())
    line = refused(2, "encode", picture, second, *more)
    assert "second.png would be OUT" in line
    assert "--output-dir" in line
    assert second.read_bytes() == picture.read_bytes()


@pytest.mark.parametrize("name", ["hopper.sgi", "icc_profile.png", "truncated_jpeg.jpg", "la.tga"])
def test_a_picture_is_known_by_its_content(picture: Path, name: str) -> None:
    """Whether it is called a stream, is damaged, or is of a format without a signature."""
    target = picture.with_name("x.sgi")
    target.write_bytes((PICTURES / name).read_bytes())
    assert "it is a picture" in refused(2, "encode", picture, target, "-f")
    assert target.read_bytes() == (PICTURES / name).read_bytes()
    done("encode", picture, "-f")  # scene.sgi


@pytest.mark.parametrize("name", ["x.bin", "x.png", "x.sgi.bak"])
def test_out_has_the_suffix_of_streams_or_is_named(picture: Path, name: str) -> None:
    target = picture.with_name(name)
    assert "does not end in .sgi" in refused(2, "encode", picture, target)
    assert not target.exists()
    done("encode", picture, "-o", target, "--steps", 2)
    assert imread(target).shape == (32, 48, 3)


@pytest.mark.parametrize(
    "arguments",
    [
        *(
            ["info", ""],
            ["verify", ""],
            ["decode", ""],
            ["encode", ""],
            ["encode", "a.png", ""],
            ["strip", "a.sgi", ""],
        ),
        *(["refine", "", "a.sgi", "b.sgi"], ["view", ""], ["serve", ""], ["encode", "a.png", "--output-dir", ""]),
    ],
)
def test_an_empty_name_is_no_folder(arguments: list[str]) -> None:
    """As a variable of the shell that is not set: not the working folder, which `sgi serve` would show to others."""
    assert "the name is empty; see sgi" in refused(2, *arguments)
