"""Decodes are measured in processes of their own, of one version or of two."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks import _decode_cases as decode_cases
from benchmarks.decode import main

STREAM = Path(__file__).parents[2] / "conformance" / "golden" / "one-pixel.sgi"


def test_a_row_for_each_case_of_both() -> None:
    arguments = [str(STREAM), "--against", sys.executable, "--repeat", "1"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in result.output.splitlines()[4:] if line]
    assert len(rows) == 3 + 8
    for _, ours, theirs, ratio in rows:
        assert float(ratio) == pytest.approx(float(ours) / float(theirs), rel=0.2)


def test_cases_take_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decode_cases, "LEAST_SECONDS", 0.0)
    found = decode_cases.measured(str(STREAM.with_name("rgb8.sgi")), 1)
    assert 0 < found["open"] < found["open, whole picture"]
    assert found["open"] < found["open, whole picture, by the clock"]
