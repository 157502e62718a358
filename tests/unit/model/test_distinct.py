"""Distinct values against numpy's."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from sgicodec.model.distinct import distinct


@pytest.mark.parametrize("size", [(0,), (1,), (50,), (7, 9)])
def test_each_value_once_and_ascending(size: tuple[int, ...]) -> None:
    values = np.random.default_rng(3).integers(-4, 5, size).astype(np.int8)
    found = distinct(values)
    assert found.dtype == values.dtype
    np.testing.assert_array_equal(found, np.unique(values))


def test_masked_arrays_are_not_loaded() -> None:
    code = "import sys, numpy as np; from sgicodec.model.distinct import distinct\n"
    code += "distinct(np.arange(3)); sys.exit('numpy.ma' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
