"""An encode is measured until its fits begin."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.start import ROWS, main
from sgicodec.image import write
from sgicodec.picture import Picture


@pytest.mark.parametrize(("effort", "scouts"), [(1, False), (2, True)])
def test_a_row_for_each_figure_of_both(tmp_path: Path, effort: int, scouts: bool) -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (64, 64, 3)).astype(np.uint8)
    path = tmp_path / "in.png"
    write(Picture(pixels, "rgb", (0.0, 255.0)), path)
    result = CliRunner().invoke(
        main, [str(path), "--against", sys.executable, "--repeat", "1", "--effort", str(effort)]
    )
    assert result.exit_code == 0, result.output
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in result.output.splitlines()[2:]]
    assert [row[0] for row in rows] == list(ROWS)
    for _, ours, _, theirs, _, ratio in rows:
        assert float(ratio) == pytest.approx(float(ours) / float(theirs), rel=0.05)
    first, _, own, _ = (float(row[1]) for row in rows)
    assert first > 0
    assert (first < own) == scouts
