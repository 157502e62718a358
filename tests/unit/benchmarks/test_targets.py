"""Figures of the targets benchmark, by hand and from one real run in a few steps."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks import targets
from benchmarks.targets import Outcome, Point, Target, loss, report, summary, targets_of
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.errors import UsageError

DATA = Path(__file__).parents[2] / "data" / "pictures"


def point(size: int, psnr: float, seconds: float = 1.0, cpu: float = 2.0) -> Point:
    return Point(size, size / 1000, psnr, 0.01, seconds, cpu)


def test_loss_is_measured_along_the_nearest_plain_points() -> None:
    plain = [point(1000, 30.0), point(2000, 33.0), point(16_000, 50.0)]
    assert loss(point(1000, 29.5), plain) == pytest.approx(0.5)
    assert loss(point(1414, 31.5), plain) == pytest.approx(0.0, abs=1e-3)
    assert loss(point(500, 27.0), plain) == pytest.approx(0.0)
    assert loss(point(900, 29.0), [*plain, point(1001, 20.0)]) == pytest.approx(30 - 3 * math.log2(1 / 0.9) - 29)
    assert math.isnan(loss(point(500, 27.0), [plain[0], plain[0]]))


def test_rows_and_summary() -> None:
    ones = [
        Outcome("a", Target("bpp", 1.0), point(990, 30.0, 2.4), point(1000, 30.0, 2.0), False),
        Outcome("a", Target("bpp", 2.0), point(1980, 32.0, 2.0, 2.5), point(2000, 33.0, 2.0), False),
        Outcome("a", Target("psnr", 35.0), point(3000, 34.5, 3.0), point(3000, 35.0, 2.0), True),
    ]
    rows = [dict(zip(targets.COLUMNS, row.split("\t"), strict=True)) for row in report(ones)]
    assert [row["reached"] for row in rows] == ["0.99", "1.98", "34.5!"]
    assert [row["ratio"] for row in rows] == ["1.200", "1.000", "1.500"]
    assert [row["cpu_ratio"] for row in rows] == ["1.000", "1.250", "1.000"]
    lines = summary({"a": ones})
    assert lines[0].startswith("# bpp: reached / target from 99.00 % to 99.00 %; time ratio median 1.10, most 1.20, of")
    assert lines[1].startswith("# psnr: reached − target from -0.500 to -0.500 dB; time ratio median 1.50")


def test_goals_from_text() -> None:
    assert targets_of("bpp", "0.15,0.3") == [Target("bpp", 0.15), Target("bpp", 0.3)]
    assert targets_of("psnr", "") == []
    with pytest.raises(UsageError, match="--psnr 30;31"):
        targets_of("psnr", "30;31")


@pytest.mark.parametrize("name", ["bpp", "size", "psnr"])
def test_settings_and_what_is_reached(name: str) -> None:
    target = Target(name, 20.0)
    settings = target.put_into(EncodeSettings(effort=2))
    assert (settings.effort, getattr(settings, name)) == (2, 20.0)
    assert target.reached(Point(8000, 0.5, 31.0, 0.1, 1.0, 1.5)) == {"bpp": 0.5, "size": 8000.0, "psnr": 31.0}[name]


def test_a_run() -> None:
    """A size within reach, and one that no stream has."""
    arguments = [str(DATA / "hopper_gray.jpg"), "--bpp", "0.8,0.001", "--psnr", "25", "--effort", "1"]
    result = CliRunner().invoke(targets.main, arguments)
    assert result.exit_code == 0, result.output
    table = [line.split("\t") for line in result.output.splitlines() if not line.startswith("#")]
    assert table[0] == list(targets.COLUMNS)
    reached = [row[3] for row in table[1:]]
    assert 0.97 * 0.8 <= float(reached[0]) <= 0.8
    assert reached[1].endswith("!")
    assert float(reached[2]) == pytest.approx(25, abs=0.1)
