"""What is measured of pictures that the codec does not suit."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import unsuited


def test_what_is_kept_of_contrast() -> None:
    original = unsuited.drawn(192)["text"]
    assert unsuited.kept_contrast(original, original) == (pytest.approx(1.0), pytest.approx(0.0))
    half = (128 + (original.astype(int) - 128) // 2).astype(np.uint8)
    slope, invented = unsuited.kept_contrast(original, half)
    assert slope == pytest.approx(0.5, abs=0.01)
    assert invented < 0.01
    noise = np.random.default_rng(1).integers(0, 256, original.shape, np.uint8)
    slope, invented = unsuited.kept_contrast(original, noise)
    assert abs(slope) < 0.1
    assert invented > 0.5


def test_the_pictures_are_what_they_are_called() -> None:
    drawn = unsuited.drawn(192)
    assert {pixels.shape for pixels in drawn.values()} == {(192, 192, 3)}
    assert drawn["faint text"].max() - drawn["faint text"].min() == unsuited.FAINT
    for name in ("text", "line art", "screenshot"):
        assert drawn[name].max() - drawn[name].min() > 200


def test_a_run_prints_what_it_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unsuited, "drawn", lambda: {"text": unsuited._text(64, 11, 0, 255)})
    result = CliRunner().invoke(unsuited.main, ["--qualities", "20,95", "--effort", "1"])
    assert result.exit_code == 0, result.output
    columns, *rows = (line.split("\t") for line in result.output.splitlines())
    assert tuple(columns) == unsuited.COLUMNS
    low, high = ({name: row[at] for at, name in enumerate(columns)} for row in rows)
    assert (low["picture"], low["quality"], high["quality"]) == ("text", "20", "95")
    assert int(low["bytes"]) < int(high["bytes"])
    assert float(low["psnr"]) < float(high["psnr"])
    assert float(low["strokes"]) < float(high["strokes"])
