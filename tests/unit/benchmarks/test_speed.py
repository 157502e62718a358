"""Seconds of encodes and decodes, of real ones in a few steps."""

from __future__ import annotations

from pathlib import Path

from click.testing import CliRunner

from benchmarks.profile import OTHER, by_module, profiled
from benchmarks.profile import main as profile
from benchmarks.speed import main, measure
from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ONE_THREAD

DATA = Path(__file__).parents[2] / "data" / "pictures"


def test_a_measured_stream_is_that_of_the_picture() -> None:
    speed, data = measure(DATA / "hopper_gray.jpg", EncodeSettings(steps=5), ONE_THREAD, 2)
    assert speed.bytes == len(data)
    with open_stream(data) as stream:
        assert stream.picture().channels == "gray"
    assert min(speed.encode, speed.encode_cpu, speed.decode) > 0


def test_rows_of_speed() -> None:
    arguments = [str(DATA / "hopper_gray.jpg"), "--steps", "5", "--repeat", "1", "--fresh", "1"]
    result = CliRunner().invoke(main, arguments, catch_exceptions=False)
    heading, _, row = result.output.splitlines()
    assert heading.count("|") == row.count("|") == 8
    assert [float(cell) > 0 for cell in row.split("|")[2:-1]] == [True] * 6


def test_modules_of_an_encode() -> None:
    picture, settings = read(DATA / "hopper_gray.jpg"), EncodeSettings(steps=3)
    stats = profiled(lambda: encode_picture(picture, settings, device=ONE_THREAD), 2)
    modules = by_module(stats, 2)
    assert {"encoder/tile/stages.py", "raster/cpu.py", OTHER} <= modules.keys()
    assert sum(modules.values()) * 2 <= stats.total_tt * 1.001  # type: ignore[attr-defined]
    assert list(modules.values()) == sorted(modules.values(), reverse=True)


def test_the_profile() -> None:
    arguments = [str(DATA / "hopper_gray.jpg"), "--steps", "3", "--functions", "2", "--repeat", "1"]
    lines = CliRunner().invoke(profile, arguments, catch_exceptions=False).output.splitlines()
    assert " ms, mean of 1" in lines[0]
    assert sum(float(line.split("|")[2]) for line in lines[4:] if line.startswith("|")) > 0
    assert any(line.startswith("| raster/cpu.py |") for line in lines)
