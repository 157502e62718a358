"""The benchmark of texture: its layers, and that it runs."""

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.texture import full_layer, main


@pytest.mark.parametrize("log_size", [3, 5])
def test_layers_are_full(log_size: int) -> None:
    layer = full_layer(70, 40, log_size, 0.5)
    side = 1 << log_size
    assert layer.count == -(-70 // side) * -(-40 // side)
    held = layer.amplitudes.reshape(-1, side, side) != 0
    assert held[:, : side // 2, : side // 2].all()
    assert held.sum() == held[:, : side // 2, : side // 2].size
    assert np.abs(layer.draw()).min() > 0


def test_a_line_for_each_case() -> None:
    options = ["--width", "64", "--height", "40", "--repeat", "1", "--scale", "1", "--scale", "0.5"]
    result = CliRunner().invoke(main, options, catch_exceptions=False)
    lines = [line.split() for line in result.output.splitlines()[1:]]
    assert [line[:3] for line in lines[:3]] == [["8", "1.00", "1.00"], ["8", "1.00", "0.50"], ["8", "0.50", "1.00"]]
    assert len(lines) == 18
    assert all(float(line[4]) >= 0 for line in lines)
