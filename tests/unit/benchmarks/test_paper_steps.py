"""Costs of the paper profile's steps: of each phase of the published schedule, and in a table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from click.testing import CliRunner
from PIL import Image

from benchmarks.paper_steps import Cost, Times, main, measure, table
from sgicodec.device import ONE_THREAD
from sgicodec.profiles.fit_settings import Phase
from sgicodec.profiles.paper import paper_settings


def test_each_phase_of_the_schedule_is_measured() -> None:
    target = np.random.default_rng(2).random((3, 48, 64), np.float32)
    costs = list(measure(target, seeds=12, warm=20, repeat=1, device=ONE_THREAD))
    assert [cost.phase for cost in costs] == list(paper_settings(0.001, 3, 15_000).phases)
    assert all(times.clock > 0 for cost in costs for times in (cost.step, cost.raster))


def test_the_fit_is_the_sum_of_its_phases() -> None:
    free = Cost(Phase(100, level=2), Times(0.006, 0.012), Times(0.004, 0.006))
    priced = Cost(Phase(200, rate=True, rounding="noise"), Times(0.03, 0.06), Times(0.02, 0.05))
    lines = table([free, priced]).splitlines()
    assert lines[2] == "| 1/4 of the size, free | 6.00 | 4.00 | 1.50 | 12.00 | 6.00 | 2.00 |"
    assert lines[3] == "| full size, bits count | 30.00 | 20.00 | 1.50 | 60.00 | 50.00 | 1.20 |"
    assert lines[-1] == "All 300 steps at this pace: 0.1 min, 0.2 of the processors."


def test_the_command_prints_a_row_for_each_phase(tmp_path: Path) -> None:
    path = tmp_path / "picture.png"
    Image.fromarray(np.random.default_rng(3).integers(0, 256, (40, 56, 3), np.uint8)).save(path)
    result = CliRunner().invoke(main, [str(path), "--seeds", "8", "--fit", "0", "--repeat", "1", "--threads", "1"])
    assert result.exit_code == 0, result.output
    assert "56×40, 80 Gaussians" in result.output
    assert result.output.count("of the size") == 4
    assert result.output.count("full size") == 2
