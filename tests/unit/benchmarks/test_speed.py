"""Seconds of encodes and decodes, of real ones in a few steps."""

from __future__ import annotations

from pathlib import Path

from click.testing import CliRunner

from benchmarks.speed import main

DATA = Path(__file__).parents[2] / "data" / "pictures"


def test_rows_of_speed() -> None:
    arguments = [str(DATA / "hopper_gray.jpg"), "--steps", "5", "--repeat", "1", "--fresh", "1"]
    result = CliRunner().invoke(main, arguments, catch_exceptions=False)
    heading, _, row = result.output.splitlines()
    assert heading.count("|") == row.count("|") == 8
    assert [float(cell) > 0 for cell in row.split("|")[2:-1]] == [True] * 6
