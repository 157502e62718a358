"""The benchmark of restoration runs, on what its network changes."""

import numpy as np
from click.testing import CliRunner

from benchmarks.restoration import STEP, main, noisy_edges
from sgicodec.model.restoration import Restoration


def test_there_is_something_to_restore() -> None:
    drawn = noisy_edges(60, 50)
    assert drawn.shape == (3, 50, 60)
    assert np.abs(Restoration(3, STEP).correction(drawn)).mean() > 1e-3


def test_a_line_for_each_instruction_set() -> None:
    options = ["--width", "64", "--height", "40", "--repeat", "1", "--isa", "portable", "--isa", "auto"]
    result = CliRunner().invoke(main, options, catch_exceptions=False)
    lines = [line.split() for line in result.output.splitlines()[1:]]
    assert [line[0] for line in lines] == ["portable", "auto"]
    assert all(float(line[2]) > 0 for line in lines)
