"""Pictures of several tiles and many files on the command line."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any, BinaryIO

import pytest
from command import done, sgi, told

from sgicodec import read
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder import streams
from sgicodec.encoder.tile.state import Tile
from sgicodec.encoder.tiles import tasks
from sgicodec.files.lock import locked

OPTIONS = ("--tile", 32, "--steps", 4, "-j", 1)


@pytest.fixture
def tiled(picture: Path) -> Path:
    """scene.png in four tiles."""
    done("encode", picture, *OPTIONS, "--quiet")
    return picture.with_suffix(".sgi")


def test_report_and_info(picture: Path, tmp_path: Path) -> None:
    result = done("encode", picture, tmp_path / "a.sgi", *OPTIONS, "--json")
    report, size = json.loads(result.stdout), (tmp_path / "a.sgi").stat().st_size
    assert report["tiles"] == 2
    assert report["bytes"] == size
    assert sum(report["parts"].values()) == pytest.approx(size)
    assert "2 tiles of 28×32 pixels, 1 worker, about" in result.stderr
    facts = told("info", tmp_path / "a.sgi", "--survey")
    assert facts["tiles"] == 2
    assert facts["seeds"] == report["seeds"]
    assert sum(facts["parts"].values()) == size
    assert "2 (2×1) of up to 32 pixels" in sgi("info", tmp_path / "a.sgi").stdout
    assert sgi("verify", tmp_path / "a.sgi").stdout.endswith(f"symbols {facts['symbol_crc']}\n")


def test_an_overview_on_request(picture: Path, tmp_path: Path) -> None:
    plain, with_one = (tmp_path / name for name in ("plain.sgi", "with.sgi"))
    done("encode", picture, plain, *OPTIONS)
    report = told("encode", picture, with_one, *OPTIONS, "--overview")
    assert sum(report["parts"].values()) == pytest.approx(with_one.stat().st_size)
    facts = told("info", with_one)
    with open_stream(with_one) as stream:
        assert facts["overview"] == [stream.overview.width, stream.overview.height]
        assert stream.overview.width == round(stream.width / 16)
    added = with_one.stat().st_size - plain.stat().st_size
    assert added - 4 <= facts["parts"]["overview"] <= added  # what the index says of offsets may grow
    assert "overview" in sgi("info", with_one).stdout
    assert told("info", plain)["overview"] is None
    shown, exact = tmp_path / "small.png", tmp_path / "exact.png"
    done("decode", with_one, shown, "--scale", "1/16")
    done("decode", with_one, exact, "--scale", "1/16", "--exact")
    assert (read(shown).pixels != read(exact).pixels).any()


@pytest.mark.parametrize("are_many", [False, True])
def test_interrupt_keeps_what_is_done(
    picture: Path, tiled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, are_many: bool
) -> None:
    fit, fitted = tasks.encode, []

    def interrupted(tile: Tile) -> object:
        if tile.number == 1 and fitted.count(1) == 0:
            fitted.append(1)
            raise KeyboardInterrupt
        fitted.append(tile.number)
        return fit(tile)

    monkeypatch.setattr(tasks, "encode", interrupted)
    out = tmp_path / "a.sgi"
    first, last = (shutil.copy(picture, tmp_path / name) for name in ("a.png", "last.png"))
    stopped = sgi("encode", first, *([last, "--output-dir", tmp_path] if are_many else [out]), *OPTIONS)
    assert stopped.exit_code == 130
    assert fitted == [0, 1]
    assert "1 of 2 tiles are in" in stopped.stderr
    assert not out.exists()
    assert (tmp_path / "a.sgi.part").exists()
    assert sgi("encode", picture, out, *OPTIONS).exit_code == 6
    assert sgi("encode", picture, out, *OPTIONS, "--resume", "-q", 51).exit_code == 2
    done("encode", picture, out, *OPTIONS, "--resume")
    assert fitted == [0, 1, 1]
    assert out.read_bytes() == tiled.read_bytes()
    assert not (tmp_path / "a.sgi.part").exists()


@pytest.mark.parametrize(("tile", "also"), [(0, []), (0, ["-f"]), (32, []), (32, ["-f"]), (32, ["--resume"])])
def test_two_encodes_to_one_out(picture: Path, tmp_path: Path, also: list[str], tile: int) -> None:
    """The second is refused at once, and told who writes; the first ends well."""
    pytest.importorskip("fcntl")
    out = tmp_path / "a.sgi"
    with locked(out):
        second = sgi("encode", picture, out, "--tile", tile, "-j", 1, "--steps", 1, *also)
    assert second.exit_code == 6
    assert f"a.sgi is being written by process {os.getpid()} on" in second.stderr
    assert list(tmp_path.glob("a*")) == []
    done("encode", picture, out, "--tile", tile, "-j", 1, "--steps", 1, *also)
    assert [path.name for path in tmp_path.glob("*a.sgi*")] == ["a.sgi"]


@pytest.mark.parametrize("tile", [0, 32])
def test_too_little_memory_is_refused(picture: Path, tmp_path: Path, tile: int) -> None:
    result = sgi("encode", picture, tmp_path / "a.sgi", "--tile", tile, "--steps", 1, "--max-memory", "100MiB")
    assert (result.exit_code, list(tmp_path.glob("*a.sgi*"))) == (2, [])
    assert "MiB, more than --max-memory; a smaller --tile takes less" in result.stderr
    done("encode", picture, tmp_path / "a.sgi", "--tile", tile, "--steps", 1, "--max-memory", "150MiB", "-j", 1)


@pytest.mark.parametrize("tile", [0, 32])
def test_a_stream_that_does_not_decode_gets_no_name(
    picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tile: int
) -> None:
    """It is verified first: the old OUT is still there."""
    real = streams.write_stream

    def damaged(file: BinaryIO, *others: Any) -> int:
        size = real(file, *others)
        file.seek(size // 2)
        file.write(b"damage")
        return size

    monkeypatch.setattr(streams, "write_stream", damaged)
    out = tmp_path / "a.sgi"
    out.write_bytes(b"before")
    assert sgi("encode", picture, out, "--tile", tile, "--steps", 4, "-f").exit_code == 4
    assert out.read_bytes() == b"before"
    assert len(list(tmp_path.iterdir())) == (3 if tile else 2), "the checkpoint of tiles"
