"""The rasteriser's benchmark: what it counts, and that it runs."""

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import raster
from benchmarks.raster import Scene, main, measure, pairs_within

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


def test_scenes_are_what_they_say() -> None:
    means, covariances, colours = Scene(20_000, 4.0).gaussians()
    assert (means.shape, covariances.shape, colours.shape) == ((20_000, 2), (20_000, 3), (20_000, 3))
    area = np.sqrt(covariances[:, 0] * covariances[:, 2] - covariances[:, 1] ** 2)
    assert np.exp(np.log(area).mean() / 2) == pytest.approx(4.0, rel=0.01)


def test_every_pass_is_timed() -> None:
    speed = measure(SMALL, threads=1, repeat=2)
    assert min(speed.forward, speed.backward, speed.squared_error) > 0
    assert speed.pairs > 0


def test_the_command_prints_a_table(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(raster, "SCENES", (SMALL, Scene(300, 1.0, 60, 45)))
    result = CliRunner().invoke(main, ["--threads", "1", "--repeat", "1", "--isa", "portable"])
    assert result.exit_code == 0, result.output
    lines = result.output.splitlines()
    assert lines[0].startswith("portable, 1 thread,")
    assert [line.count("|") for line in lines[2:]] == [11] * 4
