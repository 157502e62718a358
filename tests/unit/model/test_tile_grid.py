"""The geometry of tiles against pixels counted one by one, and which tiles draw a run of pixels against each pixel
looked at by itself as docs/format.md says ("Cross-fade").
"""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.model.tile_grid import Axis, TileGrid


@st.composite
def grids(draw: st.DrawFn) -> TileGrid:
    tile = draw(st.integers(32, 80))
    return TileGrid(draw(st.integers(1, 300)), draw(st.integers(1, 300)), tile, draw(st.integers(0, tile // 4)))


@given(grids())
def test_cores_cover_every_pixel_once(grid: TileGrid) -> None:
    covered = np.zeros((grid.height, grid.width), int)
    for number in range(grid.count):
        x, y, width, height = grid.core(number)
        assert 0 < max(width, height) <= grid.tile
        covered[y : y + height, x : x + width] += 1
    assert (covered == 1).all()


@given(grids())
def test_rects_are_cores_and_aprons_inside_the_picture(grid: TileGrid) -> None:
    for number in range(grid.count):
        x, y, width, height = grid.core(number)
        left, top, wide, high = grid.rect(number)
        assert left == (x - grid.apron if x else 0)
        assert top == (y - grid.apron if y else 0)
        assert left + wide == (x + width + grid.apron if x + width < grid.width else grid.width)
        assert top + high == (y + height + grid.apron if y + height < grid.height else grid.height)


def shown(axis: Axis, at: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """The tile that draws each place, the one before the edge where there are two, and the next one's share or -1."""
    edges = np.array([axis.edge(index) for index in range(1, axis.count)], np.float64)
    tile = (at[:, None] >= edges + axis.apron).sum(axis=1)
    edge = np.append(edges, np.inf)[tile]
    fades = at >= edge - axis.apron
    share = np.full(len(at), -1, np.float32)
    share[fades] = (at[fades] - (edge[fades] - axis.apron)) / (2 * axis.apron)
    return tile, share


@given(
    st.integers(1, 5000),
    st.integers(32, 200),
    st.data(),
    st.floats(0, 0.999),
    st.one_of(st.just(1.0), st.floats(0.001, 40)),
    st.integers(0, 3000),
    st.integers(1, 500),
)
def test_segments_are_what_each_pixel_shows(
    length: int, tile: int, data: st.DataObject, where: float, scale: float, first: int, count: int
) -> None:
    axis = TileGrid(length, 1, tile, data.draw(st.integers(0, tile // 4))).across
    start = length * where
    count = min(count, max(1, int((length - start) * scale) - first))
    first = min(first, max(0, int((length - start) * scale) - count))
    begins = np.floor(start * scale * 65536 + 0.5) / 65536  # in output pixels
    expected, share = shown(axis, (begins + (first + np.arange(count)) + 0.5) / scale)
    reached = 0
    for begin, end, number, weight in _native.tile_segments(
        axis.length, axis.count, axis.apron, start, scale, first, count
    ):
        assert begin == reached < end
        np.testing.assert_array_equal(expected[begin:end], number)
        np.testing.assert_array_equal(share[begin:end], np.float32(-1) if weight is None else weight)
        reached = end
    assert reached == count
