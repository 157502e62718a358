"""The scale of SSIMULACRA 2 against the published one, on the middles of two very unlike photographs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.scores import main
from sgicodec import read, write

DATA = Path(__file__).parents[2] / "data"


def test_scores_are_the_published_ones(tmp_path: Path) -> None:
    for library in ("ssimulacra2", "PIL", "imagecodecs"):
        pytest.importorskip(library)
    pictures = [tmp_path / f"{name}.png" for name in ("kodim13", "kodim23")]
    for path in pictures:
        photo = read(DATA / path.name)
        write(replace(photo, pixels=np.ascontiguousarray(photo.pixels[128:384, 192:576])), path)
    result = CliRunner().invoke(main, list(map(str, pictures)), catch_exceptions=False)
    rows = [line.split("\t") for line in result.output.splitlines()[1:]]
    assert [(row[0], row[2]) for row in rows[::4]] == [("JPEG, quality", "10"), ("JPEG XL, distance", "10")]
    assert len(rows) == 8
    for _, _, published, mean, lowest, highest in rows:
        assert float(mean) == pytest.approx(float(published), abs=10)
        assert float(lowest) < float(mean) < float(highest)
