"""Seconds of encodes and decodes, of real ones in a few steps."""

from __future__ import annotations

from pathlib import Path

from click.testing import CliRunner

from benchmarks.profile import main as profile
from benchmarks.speed import main

DATA = Path(__file__).parents[2] / "data" / "pictures"


def test_rows_of_speed() -> None:
    arguments = [str(DATA / "hopper_gray.jpg"), "--steps", "5", "--repeat", "1", "--fresh", "1"]
    result = CliRunner().invoke(main, arguments, catch_exceptions=False)
    heading, _, row = result.output.splitlines()
    assert heading.count("|") == row.count("|") == 8
    assert [float(cell) > 0 for cell in row.split("|")[2:-1]] == [True] * 6


def test_the_profile() -> None:
    arguments = [str(DATA / "hopper_gray.jpg"), "--steps", "3", "--functions", "2", "--repeat", "1"]
    lines = CliRunner().invoke(profile, arguments, catch_exceptions=False).output.splitlines()
    assert " ms, mean of 1" in lines[0]
    assert sum(float(line.split("|")[2]) for line in lines[4:] if line.startswith("|")) > 0
    assert any(line.startswith("| raster/cpu.py |") for line in lines)
