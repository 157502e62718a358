"""What each quality looks like, and how many steps a picture misses."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks.look import main, missing_steps, scores_of, spread

DATA = Path(__file__).parents[2] / "data"


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """Two pictures whose scores rise by 1 with each step of quality, one four steps behind; and another codec."""
    rows = ["codec\tpicture\tquality\tbpp\tssimulacra2", "webp\tkodim13.png\t40\t9\t99"]
    for quality in (40, 50, 60, 70):
        rows.append(f"sgi\tkodim13.png\t{quality}\t{quality / 50}\t{quality - 4}")
        rows.append(f"sgi\tkodim23.png\t{quality}\t{quality / 100}\t{quality}")
    path = tmp_path / "results.tsv"
    path.write_text("\n".join(rows) + "\n", "utf-8")
    return path


def test_the_spread_of_each_quality(table: Path) -> None:
    lines = spread(scores_of(table, "sgi"))
    assert lines[0] == "| 40 | 38.0 (36.0–40.0) | 0.60 |"
    assert len(lines) == 4


def test_steps_that_bring_pictures_together(table: Path) -> None:
    assert missing_steps(scores_of(table, "sgi")) == {
        "kodim13.png": pytest.approx(2),
        "kodim23.png": pytest.approx(-2),
    }


def test_the_command(table: Path) -> None:
    pictures = [str(DATA / name) for name in ("kodim13.png", "kodim23.png")]
    result = CliRunner().invoke(main, [str(table), *pictures], catch_exceptions=False)
    assert "| 70 | 68.0 (66.0–70.0) | 1.05 |" in result.output
    assert "standard deviation 2.00, 0.00 with" in result.output
    nothing = CliRunner().invoke(main, [str(table), "--codec", "avif"])
    assert nothing.exit_code == 2
    assert "no scores of avif" in nothing.output
