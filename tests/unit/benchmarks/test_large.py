"""The benchmark of large pictures, on tiny ones."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

pytest.importorskip("PIL")
pytest.importorskip("imagecodecs")
pytest.importorskip("matplotlib")

from benchmarks.large import command, notes, peer, runs, sgi, trips
from benchmarks.large.jpeg_tiff import write_jpeg_tiff
from benchmarks.large.match import TOLERANCE, Probes, match, nearest_rung
from benchmarks.large.notes import Job, Notes, Trip, psnr_of
from benchmarks.large.peers import LARGE_PEERS, JpegTiff
from benchmarks.large.rows import LargeRow, read_rows, report, write_rows
from benchmarks.large.scaling import read_sizes, write_crop
from benchmarks.large.sgi import Counting, middle_region
from benchmarks.large.trips import RefusedError, peer_trip, sample_of
from sgicodec.bench.sgi import Run
from sgicodec.cli.main import cli as sgi_command
from sgicodec.errors import SgiError, UsageError
from sgicodec.image import open_source, read, write
from sgicodec.model.tile_grid import TileGrid
from sgicodec.picture import Picture

KODIM = Path(__file__).parents[2] / "data" / "kodim23.png"


class InProcess:
    """Takes the place of `run_timed`: the same commands, without starting Python each time."""

    def __init__(self) -> None:
        self.commands: list[list[str]] = []

    def __call__(self, command: Sequence[str]) -> Run:
        module, arguments = command[2], list(command[3:])
        self.commands.append([module, *arguments])
        main = {"sgicodec": sgi_command, "benchmarks.large.peer": peer.main}[module]
        done = CliRunner().invoke(main, arguments)
        if done.exit_code:
            raise SgiError(f"`{module}` failed: {done.output}{done.exception}")
        return Run(1.5, 64.0, 1.25)


@pytest.fixture
def processes(monkeypatch: pytest.MonkeyPatch) -> InProcess:
    runner = InProcess()
    monkeypatch.setattr(sgi, "run_timed", runner)
    monkeypatch.setattr(trips, "run_timed", runner)
    return runner


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """176×132 pixels of a photograph."""
    path = tmp_path_factory.mktemp("large") / "tiny.png"
    write(Picture(read(KODIM).pixels[200:332, 100:276].copy(), "rgb", (0.0, 255.0)), path)
    return path


def trip(psnr: float, size: int = 1000) -> Trip:
    return Trip("", "", size, psnr, Run(1, 1, 1), Run(1, 1, 1))


def curve(base: float) -> Probes:
    """A codec of 0.25 dB and 3 % more bytes with every rung."""
    return Probes(lambda rung: trip(base + 0.25 * rung, round(1e6 * 1.03**rung)))


# Matching


@pytest.mark.parametrize("target", [0.0, 20.0, 20.1, 27.6, 44.74, 44.75, 99.0])
def test_the_nearest_rung_is_that_of_a_full_search(target: float) -> None:
    ladder = [20 + 0.25 * rung for rung in range(100)]
    found = nearest_rung(ladder.__getitem__, target, 100)
    assert abs(ladder[found] - target) == min(abs(psnr - target) for psnr in ladder)


def test_the_whole_picture_is_brought_to_the_psnr_though_the_sample_differs() -> None:
    sample, whole = curve(20), curve(22.5)
    found = match(33.05, 100, sample, whole)
    assert abs(found.trip.psnr - 33.05) <= TOLERANCE
    assert len(whole.made) == 2
    assert len(sample.made) <= 14


def test_bytes_are_brought_to_the_very_psnr_along_the_curve() -> None:
    probe = curve(20)
    found = match(30.1, 100, probe, probe)
    assert found.trip.psnr == 30.0
    assert found.equal_bytes == pytest.approx(1e6 * 1.03**40.4, rel=1e-4)


def test_a_ladder_that_does_not_reach_ends_at_its_end() -> None:
    probe = curve(20)
    assert match(90.0, 8, probe, probe).trip.psnr == 21.75


# The region


@pytest.mark.parametrize(
    ("size", "tile", "expected"),
    [
        ((12288, 12288), 1024, (5632, 5632, 1024, 1024)),
        ((5392, 4848), 1024, (2184, 2396, 1024, 1024)),
        ((3072, 3072), 1024, (512, 512, 1024, 1024)),
        ((3000, 700), 0, (988, 0, 1024, 700)),
        ((90, 70), 32, (0, 0, 90, 70)),
    ],
)
def test_the_region_lies_in_the_picture_around_a_corner_of_tiles(
    size: tuple[int, int], tile: int, expected: tuple[int, int, int, int]
) -> None:
    grid = TileGrid(*size, tile, 8)
    x, y, width, height = middle_region(grid)
    assert (width, height) == (min(1024, size[0]), min(1024, size[1]))
    assert 0 <= x <= x + width <= size[0]
    assert 0 <= y <= y + height <= size[1]
    if tile:
        rects = [grid.rect(number) for number in range(grid.count)]
        met = [x < at + w < x + width + w and y < to + h < y + height + h for at, to, w, h in rects]
        assert sum(met) >= 4
    assert (x, y, width, height) == expected


# Files


def test_tiled_jpeg_is_read_alike_by_two_libraries(tmp_path: Path, picture: Path) -> None:
    """And is JPEG's error away from the source, edges included."""
    from PIL import Image

    path, big = tmp_path / "x.tif", tmp_path / "big.png"
    pixels = read(KODIM).pixels[:300, :530].copy()
    write(Picture(pixels, "rgb", (0.0, 255.0)), big)
    with open_source(big) as source:
        write_jpeg_tiff(source, path, 90)
    ours = read(path).pixels
    with Image.open(path) as opened:
        assert opened.tag_v2[322] == opened.tag_v2[323] == 256  # type: ignore[attr-defined]
        assert opened.tag_v2[530] == (2, 2)  # type: ignore[attr-defined]
        theirs = np.asarray(opened.convert("RGB"))
    assert ours.shape == theirs.shape == pixels.shape
    assert np.abs(ours.astype(int) - theirs).max() <= 4
    assert psnr_of(big, path) > 36
    padded = np.pad(pixels, ((0, 212), (0, 238), (0, 0)), mode="edge")
    Image.fromarray(padded).save(tmp_path / "whole.jpg", quality=90, subsampling="4:2:0")
    assert path.stat().st_size == pytest.approx((tmp_path / "whole.jpg").stat().st_size, rel=0.02)


@pytest.mark.parametrize("name", list(LARGE_PEERS))
def test_a_region_is_the_same_part_of_everything(name: str, tmp_path: Path, picture: Path) -> None:
    codec, path = LARGE_PEERS[name](1), tmp_path / "coded.tif"
    codec.encode(picture, path, codec.rungs // 2)
    whole = np.concatenate(list(codec.bands(path, (0, 0, 176, 132))))
    part = np.concatenate(list(codec.bands(path, (30, 40, 50, 60))))
    assert whole.shape == (132, 176, 3)
    np.testing.assert_array_equal(part, whole[40:100, 30:80])


@pytest.mark.parametrize("name", list(LARGE_PEERS))
def test_higher_rungs_are_better(name: str, tmp_path: Path, picture: Path) -> None:
    codec, found = LARGE_PEERS[name](1), []
    for rung in np.linspace(0, codec.rungs - 1, 5).astype(int).tolist():
        path = tmp_path / f"{rung}.tif"
        codec.encode(picture, path, rung)
        pixels = np.concatenate(list(codec.bands(path, (0, 0, 176, 132))))
        found.append(-float(np.mean((pixels.astype(float) - read(picture).pixels) ** 2)))
    assert all(worse < better for worse, better in pairwise(found))


def test_psnr_is_that_of_all_samples(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    pair = rng.integers(0, 256, (2, 600, 37, 3)).astype(np.uint8)
    for name, pixels in zip("ab", pair, strict=True):
        write(Picture(pixels, "rgb", (0.0, 255.0)), tmp_path / f"{name}.tif")
    difference = pair[0].astype(float) - pair[1]
    expected = 10 * math.log10(255**2 / np.mean(difference**2))
    assert psnr_of(tmp_path / "a.tif", tmp_path / "b.tif") == pytest.approx(expected, abs=1e-6)


def test_the_sample_is_blocks_from_all_over_the_picture(
    tmp_path: Path, picture: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = Job(tmp_path, 1)
    assert sample_of(picture, job) == picture
    monkeypatch.setattr(trips, "_BLOCK", 16)
    pixels, sample = read(picture).pixels, read(sample_of(picture, job)).pixels
    assert sample.shape == (64, 64, 3)
    np.testing.assert_array_equal(sample[:16, :16], pixels[:16, :16])
    np.testing.assert_array_equal(sample[48:, 48:], pixels[-16:, -16:])
    np.testing.assert_array_equal(sample[16:32, 32:48], pixels[38:54, 106:122])


def test_a_crop_is_the_middle(tmp_path: Path, picture: Path) -> None:
    write_crop(picture, 100, tmp_path / "crop.tif")
    np.testing.assert_array_equal(read(tmp_path / "crop.tif").pixels, read(picture).pixels[16:116, 38:138])


def test_bytes_read_are_counted(tmp_path: Path) -> None:
    (tmp_path / "x").write_bytes(bytes(100))
    with Counting(tmp_path / "x") as file:
        file.seek(90)
        assert len(file.read(5)) == 5
        assert len(file.read(50)) == 5
        assert file.count == 10


# Notes


def test_notes_last_and_hold_for_what_was_asked_alone(tmp_path: Path) -> None:
    path, calls = tmp_path / "x.json", []

    def measure() -> float:
        calls.append(1)
        return 2.5

    assert [Notes(path, {"a": 1}).once("x", measure) for _ in range(2)] == [2.5, 2.5]
    assert len(calls) == 1
    assert "x" not in Notes(path, {"a": 2})
    path.write_text("{")
    assert "x" not in Notes(path, {"a": 1})


def test_an_interrupted_encode_counts_what_it_had_done(
    tmp_path: Path, picture: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The seconds up to its last tile; nothing if another version of the program made them."""
    stream, job = tmp_path / "x.sgi", Job(tmp_path, 1)
    part = Path(f"{stream}.part")
    commands: list[Sequence[str]] = []

    def stopped(command: Sequence[str]) -> Run:
        part.write_bytes(b"tiles")
        begun = Notes(tmp_path / "x.json", {})["attempt"]["begun"]
        os.utime(part, (begun + 40, begun + 40))
        raise SgiError("stopped")

    def finished(command: Sequence[str]) -> Run:
        commands.append(command)
        return Run(5.0, 100.0, 4.0)

    for _ in range(2):
        monkeypatch.setattr(sgi, "run_timed", stopped)
        with pytest.raises(SgiError, match="stopped"):
            sgi.encode(picture, stream, 1, job, Notes(tmp_path / "x.json", {}))
    monkeypatch.setattr(sgi, "run_timed", finished)
    assert sgi.encode(picture, stream, 1, job, Notes(tmp_path / "x.json", {})) == Run(85.0, 100.0, None)
    assert "--resume" in commands[0]
    assert part.exists()

    notes = Notes(tmp_path / "x.json", {})
    notes.clear()
    notes.put("version", "older")
    notes.put("attempt", {"begun": 0.0, "spent": 7.0})
    assert sgi.encode(picture, stream, 1, job, notes) == Run(5.0, 100.0, 4.0)
    assert not part.exists()


# Peers as processes


def test_a_peer_is_measured_as_a_process_once(tmp_path: Path, picture: Path) -> None:
    job, codec = Job(tmp_path, 1), LARGE_PEERS["jxl"](1)
    found = peer_trip(codec, picture, job, (176, 132), (8, 8, 32, 32), 70)
    pixels = np.empty((132, 176, 3), np.uint8)
    codec.encode(picture, tmp_path / "x.jxl", 70)
    pixels = np.concatenate(list(codec.bands(tmp_path / "x.jxl", (0, 0, 176, 132))))
    error = np.mean((pixels.astype(float) - read(picture).pixels) ** 2)
    assert found.psnr == pytest.approx(10 * math.log10(255**2 / error), abs=1e-6)
    assert found.bytes == (tmp_path / "x.jxl").stat().st_size
    assert found.region is not None
    assert all(run.seconds > 0 and run.peak and run.peak > 20 for run in (found.encode, found.decode, found.region))
    assert peer_trip(codec, picture, job, (176, 132), (8, 8, 32, 32), 70) == found


def test_a_refusal_is_told_and_remembered(tmp_path: Path, picture: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken, job = tmp_path / "broken.png", Job(tmp_path, 1)
    broken.write_bytes(picture.read_bytes()[:3000])
    with pytest.raises(RefusedError) as first:
        peer_trip(JpegTiff(), broken, job, (176, 132), None, 50)
    monkeypatch.setattr(trips, "run_timed", None)
    with pytest.raises(RefusedError) as second:
        peer_trip(JpegTiff(), broken, job, (176, 132), None, 50)
    assert str(first.value) == str(second.value)
    assert "broken.png" in str(first.value)


# All together


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
        assert abs(row.psnr - ours.psnr) <= (TOLERANCE if row.codec == "jxl" else 0.35)
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


def test_peers_want_rgb_of_eight_bits(tmp_path: Path) -> None:
    write(Picture(np.zeros((40, 40, 1), np.uint16), "gray", (0.0, 65535.0)), tmp_path / "deep.png")
    with pytest.raises(UsageError, match="gray of uint16"):
        runs.check_picture(tmp_path / "deep.png")


def test_notes_are_what_a_picture_depends_on(tmp_path: Path, picture: Path) -> None:
    asked = notes.Job(tmp_path, 3).asked_of(picture)
    assert asked == {"picture": "tiny.png", "picture_bytes": picture.stat().st_size, "workers": 3}
