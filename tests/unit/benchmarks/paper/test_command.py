"""The command: it goes on where it was, prints from a file alone, and tells what failed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from benchmarks.paper import measure
from benchmarks.paper.command import main, middle
from benchmarks.paper.rows import PaperResults
from sgicodec import write
from sgicodec.bench.run import load_sample
from sgicodec.errors import SgiError, UsageError
from sgicodec.picture import Picture

KODIM = Path(__file__).parents[3] / "data" / "kodim23.png"


@pytest.fixture
def picture(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.png"
    write(Picture(load_sample(KODIM).pixels[200:248, 100:164].copy(), "rgb", (0.0, 255.0)), path)
    return path


def call(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_a_run_goes_on_where_it_was(picture: Path, tmp_path: Path, processes: Any) -> None:
    options = (picture, "--steps", 6, "--seeds", 12, "--threads", 1, "--tsv", tmp_path / "paper.tsv")
    first = call(*options, "--table", "decode", "--streams", tmp_path / "streams")
    assert first.exit_code == 0, first.exception
    assert "### Decode time" in first.stdout
    assert "decode, tiny.png, low, paper profile: " in first.stderr
    assert len(list((tmp_path / "streams").iterdir())) == len(processes.commands) == 1
    both = call(*options, "--table", "decode", "--table", "levels")
    assert both.exit_code == 0, both.exception
    assert len(processes.commands) == 4  # M = 3 is the same stream as that of the table `decode`
    again = call(*options, "--table", "decode", "--table", "levels")
    assert (again.stdout, again.stderr) == (both.stdout, "")
    printed = call("--from", tmp_path / "paper.tsv", "--table", "levels")
    assert printed.stdout.strip() in both.stdout
    assert len(PaperResults(tmp_path / "paper.tsv").rows) == 5
    enlarged = call(*options, "--table", "super-resolution")
    assert enlarged.exit_code == 0, enlarged.exception
    assert len(PaperResults(tmp_path / "paper.tsv").rows) == 5 + 6  # none of the whole picture


def test_what_fails_is_told_and_the_rest_is_measured(picture: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(command: object) -> None:
        raise SgiError("no encoder here")

    monkeypatch.setattr(measure, "run_timed", refuse)
    result = call(picture, "--steps", 6, "--seeds", 12, "--table", "super-resolution", "--threads", 1)
    assert str(result.exception).startswith("3 points failed, the first of them: super-resolution, tiny.png, ×2")
    assert "bilinear, tiny.png" in result.stdout


def test_a_quick_run_takes_the_middle() -> None:
    pixels = np.arange(10 * 20 * 3).reshape(10, 20, 3).astype(np.uint8)
    assert np.array_equal(middle(pixels, 4), pixels[3:7, 8:12])
    assert middle(pixels, 16).shape == (10, 16, 3)


@pytest.mark.parametrize("arguments", [(), ("a.png", "--from", __file__)])
def test_pictures_or_a_file_are_needed(arguments: tuple[str, ...]) -> None:
    assert isinstance(call(*arguments).exception, UsageError)
