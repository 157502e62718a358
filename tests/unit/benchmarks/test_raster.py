"""The rasteriser's benchmark: what it counts, and that it runs."""

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import raster
from benchmarks.raster import Scene, main, pairs_within

SMALL = Scene(count=40, sigma=3.0, width=60, height=45)


@pytest.mark.parametrize("cutoff", [1.0, 3.5])
def test_pairs_by_brute_force(cutoff: float) -> None:
    means, covariances, colours = SMALL.gaussians()
    means[0] = [-300, 20]
    total = 0
    for (x, y), (xx, xy, yy) in zip(means.astype(float), covariances.astype(float), strict=True):
        dx = np.arange(SMALL.width) + 0.5 - x
        dy = (np.arange(SMALL.height) + 0.5 - y)[:, None]
        distance = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy)
        total += int((distance <= cutoff**2).sum())
    assert pairs_within((means, covariances, colours), cutoff, SMALL.width, SMALL.height) == total


def test_the_command_prints_a_table(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(raster, "SCENES", (SMALL, Scene(300, 1.0, 60, 45)))
    result = CliRunner().invoke(main, ["--threads", "1", "--repeat", "1", "--isa", "portable"])
    assert result.exit_code == 0, result.output
    lines = result.output.splitlines()
    assert lines[0].startswith("portable, 1 thread,")
    assert [line.count("|") for line in lines[2:]] == [10] * 4
