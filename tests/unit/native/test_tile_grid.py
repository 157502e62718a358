"""Which tiles draw a run of pixels, in native code: bit for bit what the package computes."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sgicodec import _native
from sgicodec.model.tile_grid import TileGrid


@given(
    st.integers(1, 5000),
    st.integers(32, 200),
    st.data(),
    st.floats(0, 0.999),
    st.one_of(st.just(1.0), st.floats(0.001, 40)),
    st.integers(0, 3000),
    st.integers(1, 500),
)
def test_segments_are_those_of_the_package(
    length: int, tile: int, data: st.DataObject, where: float, scale: float, first: int, count: int
) -> None:
    axis = TileGrid(length, 1, tile, data.draw(st.integers(0, tile // 4))).across
    start = length * where
    count = min(count, max(1, int((length - start) * scale) - first))
    first = min(first, max(0, int((length - start) * scale) - count))
    expected = list(axis.segments(start, scale, first, count))
    found = _native.tile_segments(axis.length, axis.count, axis.apron, start, scale, first, count)
    assert [run[:3] for run in found] == [(run.first, run.last, run.tile) for run in expected]
    for run, (*_, weight) in zip(expected, found, strict=True):
        if run.weight is None:
            assert weight is None
        else:
            np.testing.assert_array_equal(weight, run.weight, strict=True)
