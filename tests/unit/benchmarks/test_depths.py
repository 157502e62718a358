"""What is measured of one picture at several depths."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import depths

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


def test_depths_are_the_same_picture() -> None:
    unit = np.linspace(0, 1, 3 * 64).reshape(8, 8, 3)
    for name, pixels in depths.depths(unit).items():
        if name.endswith("hot pixel"):
            assert (pixels == depths.HOT).sum() == 3
            continue
        low, high = float(pixels.min()), float(pixels.max())
        np.testing.assert_allclose((pixels - low) / (high - low), unit, atol=0.003, err_msg=name)


def test_the_peak_is_the_range_in_use() -> None:
    ramp = np.linspace(0, 1000, 101)
    assert depths.range_psnr(ramp, ramp + 10) == pytest.approx(40.0)


def test_a_run_prints_what_it_measured() -> None:
    result = CliRunner().invoke(depths.main, [str(PHOTO), "--crop", "48", "--effort", "1", "--reduce", "2"])
    assert result.exit_code == 0, result.output
    title, columns, *rows = result.output.splitlines()
    assert title.startswith("# kodim23.png, 48×48")
    assert tuple(columns.split("\t")) == depths.COLUMNS
    assert [row.split("\t")[0] for row in rows] == list(depths.depths(np.zeros((1, 1, 1))))
