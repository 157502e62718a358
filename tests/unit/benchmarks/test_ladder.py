"""Bytes at equal score, seconds and stages of each effort, of a small picture."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.ladder import Point, bytes_at, main
from sgicodec import read, write

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


def test_bytes_are_those_of_the_line_through_two_points() -> None:
    points = [Point(size, score, 1.0, 1.0, 1.0) for size, score in ((1000, 50.0), (4000, 70.0), (2000, 60.0))]
    assert bytes_at(points, 55.0) == pytest.approx(1000 * 2**0.5)
    assert bytes_at(points, 70.0) == pytest.approx(4000)
    assert bytes_at(points, 80.0) == pytest.approx(8000)


def test_rows_of_efforts_and_stages(tmp_path: Path) -> None:
    photo = read(PHOTO)
    write(replace(photo, pixels=np.ascontiguousarray(photo.pixels[96:192, 160:288])), tmp_path / "crop.png")
    arguments = [str(tmp_path / "crop.png"), "--efforts", "1,2", "--no-peers", "--stages", "--repeat", "1"]
    lines = CliRunner().invoke(main, arguments, catch_exceptions=False).output.splitlines()
    rows = [line.split(" | ") for line in lines if line.startswith("| sgi")]
    assert [row[0] for row in rows] == ["| sgi -e 1", "| sgi -e 2"] * 2
    assert rows[0][4] == "+0.0 %"
    assert all(float(cell) > 0 for row in rows[:2] for cell in row[1:4])
    assert lines[-4].startswith("| processor s/MP | start | ")
    assert all(float(cell.strip(" |")) >= 0 for row in rows[2:] for cell in row[1:])
