"""Levels as arrays: chunks on the borders of tiles, parts of the whole level but for roundings."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import sgicodec
from sgicodec.plugins.level_array import level_arrays


def test_levels_are_those_of_the_stream(pyramid: Path) -> None:
    with sgicodec.open(pyramid) as stream:
        arrays = level_arrays(stream)
        assert [array.shape for array in arrays] == [(300, 520, 3), (150, 260, 3), (75, 130, 3)]
        for array, level in zip(arrays, stream.levels, strict=True):
            whole = stream.read(size=level[:2])
            np.testing.assert_array_equal(np.asarray(array), whole)
            for key in (
                (slice(100, 131), slice(31, 77)),
                (slice(None, None, -9), 5, 1),
                (..., 2),
                7,
                (slice(9, 9), slice(3)),
            ):
                np.testing.assert_allclose(array[key].astype(int), whole[key], atol=1 if level.downsample > 1 else 0)
