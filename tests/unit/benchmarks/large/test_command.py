"""The benchmark of large pictures as one command, on a tiny one."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from click.testing import CliRunner

pytest.importorskip("PIL")
pytest.importorskip("imagecodecs")
pytest.importorskip("matplotlib")
from in_process import InProcess

from benchmarks.large import command, runs
from benchmarks.large.match import TOLERANCE
from benchmarks.large.notes import Trip
from benchmarks.large.peers import LARGE_PEERS, JpegTiff
from benchmarks.large.rows import LargeRow, read_rows, report, write_rows
from benchmarks.large.scaling import read_sizes
from benchmarks.large.trips import RefusedError
from sgicodec.errors import SgiError, UsageError


def arguments(picture: Path, folder: Path) -> list[str]:
    made = ["--efforts", "1", "--workers", "1", "--streams", f"{folder}/streams", "--out", str(folder)]
    return [str(picture), *made, "--sizes", "0.004,0.012,5", "--steps", "3", "--table-steps", "12", "--tile", "64"]


@pytest.fixture
def done(tmp_path: Path, picture: Path, processes: InProcess) -> Path:
    result = CliRunner().invoke(command.main, arguments(picture, tmp_path), catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return tmp_path


def test_the_command_has_a_row_for_each_codec_at_one_psnr(done: Path, picture: Path) -> None:
    rows = read_rows(done / "results" / "large.tsv")
    assert [row.codec for row in rows] == ["sgi", *LARGE_PEERS]
    ours = rows[0]
    assert ours.bytes == (done / "streams" / "tiny-e1.sgi").stat().st_size
    assert ours.bpp == pytest.approx(8 * ours.bytes / (176 * 132), rel=1e-4)
    assert (ours.overview_seconds, ours.encode_mib) == (1.5, 64)
    assert ours.region_bytes > 0
    assert ours.overview_bytes > 0
    for row in rows[1:]:
        assert abs(row.psnr - ours.psnr) <= (2 * TOLERANCE if row.codec == "jxl" else 0.35)
        assert (abs(row.psnr - ours.psnr) > TOLERANCE) == ("no nearer" in row.note)
        assert row.equal_bpp == pytest.approx(row.bpp, rel=0.1)
        assert row.region_seconds == 1.5
        assert math.isnan(row.overview_seconds)
    points = read_sizes(done / "results" / "large-scaling.tsv")
    assert [(point.side, point.tiles) for point in points] == [(63, 1), (110, 4)]
    assert all((done / "images" / f"large-{name}.png").stat().st_size > 5000 for name in ("time", "memory"))


def test_a_second_run_measures_nothing_again(done: Path, picture: Path, processes: InProcess) -> None:
    tables = [(done / "results" / name).read_text() for name in ("large.tsv", "large-scaling.tsv")]
    count = len(processes.commands)
    assert count > 20
    again = CliRunner().invoke(command.main, arguments(picture, done), catch_exceptions=False)
    assert again.exit_code == 0
    assert len(processes.commands) == count
    assert [(done / "results" / name).read_text() for name in ("large.tsv", "large-scaling.tsv")] == tables
    (done / "streams" / "tiny-e1.sgi").unlink()
    CliRunner().invoke(command.main, [*arguments(picture, done), "--peers", "", "--sizes", ""], catch_exceptions=False)
    assert [command[1] for command in processes.commands[count:]] == ["encode", "decode", "decode", "decode"]


def test_a_codec_that_fails_has_a_row_that_says_so(
    tmp_path: Path, picture: Path, processes: InProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    def trip_of(codec: object, *rest: object) -> Trip:
        raise RefusedError("too large") if isinstance(codec, JpegTiff) else SgiError("killed")

    monkeypatch.setattr(runs, "peer_trip", trip_of)
    only = ["--peers", "jpeg-tiff,jxl", "--sizes", ""]
    result = CliRunner().invoke(command.main, [*arguments(picture, tmp_path), *only])
    assert isinstance(result.exception, SgiError)
    rows = read_rows(tmp_path / "results" / "large.tsv")
    assert [row.note for row in rows] == ["", "refused: too large", "failed: killed"]
    assert [math.isnan(row.psnr) for row in rows] == [False, True, True]


def test_rows_survive_their_table(tmp_path: Path) -> None:
    rows = [LargeRow("a", 10, 20, "jxl", 1, bytes=12345678.0, psnr=30.25, note="x"), LargeRow("a", 10, 20, "sgi", 5)]
    write_rows(rows, tmp_path / "x.tsv")
    found = read_rows(tmp_path / "x.tsv")
    assert repr(found) == repr(rows)
    assert "| a | 0.0 | 1 | jxl |  | 30.25 |" in report(found)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [(["--peers", "jpg"], "no peer is called 'jpg'"), (["--efforts", "one"], "numbers with commas")],
)
def test_what_makes_no_sense_is_refused(
    options: list[str], complaint: str, tmp_path: Path, picture: Path, processes: InProcess
) -> None:
    result = CliRunner().invoke(command.main, [*arguments(picture, tmp_path), *options])
    assert isinstance(result.exception, UsageError)
    assert complaint in str(result.exception)
    assert not processes.commands
