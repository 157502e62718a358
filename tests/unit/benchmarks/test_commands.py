"""Seconds of commands next to another version: here this one."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from click.testing import CliRunner

from benchmarks.commands import main
from sgicodec import Picture, write


def test_a_row_for_each_picture(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    write(Picture(np.random.default_rng(0).integers(0, 256, (24, 32, 3), np.uint8), "rgb", (0.0, 255.0)), path)
    options = ["--effort", "1", "--repeat", "1"]
    result = CliRunner().invoke(main, [sys.executable, str(path), *options], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    name, size, other, *figures = result.output.splitlines()[-1].strip("| ").split(" | ")
    assert name == "a"
    assert int(other) <= int(size)
    seconds, other_seconds, ratio, inside, other_inside, inside_ratio = map(float, figures)
    assert min(seconds, other_seconds) > 0.02
    assert abs(ratio - seconds / other_seconds) < 0.02 * ratio + 0.01
    assert abs(inside_ratio - inside / other_inside) < 0.02 * inside_ratio + 0.01


def test_what_fails_is_told(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(b"no picture")
    result = CliRunner().invoke(main, [sys.executable, str(path)])
    assert result.exit_code == 1
    assert "a.png" in result.output
