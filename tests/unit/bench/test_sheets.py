"""Contact sheets show the right places of the right pictures, twice as large."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec.bench.peers import Jpeg, WebP
from sgicodec.bench.sheets import write_sheets

Image = pytest.importorskip("PIL.Image")

WIDTH, HEIGHT = 160, 128  # of a detail


def noise(height: int = 200, width: int = 400) -> np.ndarray:
    return np.random.default_rng(2).integers(0, 256, (height, width, 3), np.uint8)


def test_a_file_for_each_picture_and_rate(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        Image.fromarray(np.sort(noise(), axis=1)).save(tmp_path / name)
    lines: list[str] = []
    pictures = [tmp_path / "a.png", tmp_path / "b.png"]
    paths = write_sheets(pictures, [Jpeg(), WebP()], [0.5, 1.25], tmp_path / "sheets", report=lines.append)
    stems = [(path.name.split("-")[0], path.name.split("-")[2]) for path in paths]
    assert stems == [("a", "0.5bpp.png"), ("a", "1.25bpp.png"), ("b", "0.5bpp.png"), ("b", "1.25bpp.png")]
    assert all(Image.open(path).width > 3 * 2 * WIDTH for path in paths)
    assert lines[1].startswith(f"{paths[1].name}: {int(1.25 * 200 * 400 / 8)} bytes; jpeg ")
