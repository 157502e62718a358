"""The benchmark of the native scores: both of SSIMULACRA 2 agree, and everything is timed."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.gradient import HEADINGS, main


def test_it_prints_both_scores_and_their_times(tmp_path: Path) -> None:
    pytest.importorskip("ssimulacra2")
    Image = pytest.importorskip("PIL.Image")
    pixels = np.random.default_rng(1).integers(60, 200, (40, 50, 3), np.uint8)
    Image.fromarray(pixels).save(tmp_path / "noise.png")
    result = CliRunner().invoke(main, [str(tmp_path / "noise.png"), "--repeat", "1"])
    assert result.exit_code == 0, result.output
    headings, values = (line.split("\t") for line in result.output.splitlines())
    assert headings == list(HEADINGS)
    assert values[0] == "noise.png"
    assert float(values[1]) == pytest.approx(float(values[2]), abs=0.01)
    assert min(map(float, values[3:])) >= 0
