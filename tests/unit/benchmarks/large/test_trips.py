"""What each codec is asked to do, on tiny pictures: files, regions, notes, processes."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("PIL")
pytest.importorskip("imagecodecs")
pytest.importorskip("matplotlib")
from benchmarks.large import notes, runs, sgi, trips
from benchmarks.large.jpeg_tiff import write_jpeg_tiff
from benchmarks.large.notes import Job, Notes, Trip, psnr_of
from benchmarks.large.peers import LARGE_PEERS, JpegTiff
from benchmarks.large.scaling import write_crop
from benchmarks.large.sgi import Counting
from benchmarks.large.trips import RefusedError, peer_trip, sample_of
from sgicodec.bench.sgi import Run
from sgicodec.errors import SgiError, UsageError
from sgicodec.image import open_source, read, write
from sgicodec.picture import Picture

KODIM = Path(__file__).parents[3] / "data" / "kodim23.png"


def trip(psnr: float, size: int = 1000) -> Trip:
    return Trip("", "", size, psnr, Run(1, 1, 1), Run(1, 1, 1))


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


def test_peers_want_rgb_of_eight_bits(tmp_path: Path) -> None:
    write(Picture(np.zeros((40, 40, 1), np.uint16), "gray", (0.0, 65535.0)), tmp_path / "deep.png")
    with pytest.raises(UsageError, match="gray of uint16"):
        runs.check_picture(tmp_path / "deep.png")


def test_notes_are_what_a_picture_depends_on(tmp_path: Path, picture: Path) -> None:
    asked = notes.Job(tmp_path, 3).asked_of(picture)
    assert asked == {"picture": "tiny.png", "picture_bytes": picture.stat().st_size, "workers": 3}
