"""Forecasts are compared with what came, and exponents found that made it."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from sgicodec.image import read, write
from tools.rd_model_constants import Outcome, exponents, main

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


@pytest.mark.parametrize("of_error", [True, False])
def test_exponents_are_found(of_error: bool) -> None:
    rng = np.random.default_rng(3)
    true = np.array([2.5, 0.9, 2.0, -1.0, 0.5, -0.25])
    found = []
    for _ in range(40):
        seeds = tuple(np.exp(rng.normal(size=5)))
        value = true[0] * float(np.prod(np.array(seeds) ** true[1:]))
        size = round(200 + 1e7 * value)
        found.append(Outcome("", 50, size, value, (1.0, 1.0), seeds, 10**7))
    solved, off = exponents(found, of_error)
    assert solved == pytest.approx(true, abs=1e-2)
    assert off < 1e-2


def test_rows_and_sums(tmp_path: Path) -> None:
    picture = read(PHOTO)
    path = tmp_path / "crop.png"
    write(type(picture)(np.ascontiguousarray(picture.pixels[:96, :128]), "rgb", (0.0, 255.0)), path)
    lines = CliRunner().invoke(main, [str(path), "--qualities", "20,50,80", "--effort", "1"], catch_exceptions=False)
    rows = [line.split("\t") for line in lines.output.splitlines() if line.startswith("crop")]
    assert [row[1] for row in rows] == ["20", "50", "80"]
    assert sorted(int(row[2]) for row in rows) == [int(row[2]) for row in rows]
    assert all(math.isfinite(float(cell)) and abs(float(cell)) < 2 for row in rows for cell in row[4:])
    told = re.search(r"error off by (\S+) ± (\S+) octaves", lines.output)
    assert told
    off = [float(row[5]) for row in rows]
    assert (float(told[1]), float(told[2])) == pytest.approx((np.mean(off), np.std(off)), abs=0.02)
