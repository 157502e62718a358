"""The scale of SSIMULACRA 2 against the published one, on two photographs that could hardly differ more."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks.scores import main

DATA = Path(__file__).parents[2] / "data"


def test_scores_are_the_published_ones() -> None:
    for library in ("ssimulacra2", "PIL", "imagecodecs"):
        pytest.importorskip(library)
    pictures = [str(DATA / f"{name}.png") for name in ("kodim13", "kodim23")]
    result = CliRunner().invoke(main, pictures, catch_exceptions=False)
    rows = [line.split("\t") for line in result.output.splitlines()[1:]]
    assert [(row[0], row[2]) for row in rows[::4]] == [("JPEG, quality", "10"), ("JPEG XL, distance", "10")]
    assert len(rows) == 8
    for _, _, published, mean, lowest, highest in rows:
        assert float(mean) == pytest.approx(float(published), abs=10)
        assert float(lowest) < float(mean) < float(highest)
