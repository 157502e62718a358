"""The geometry of tiles, against pixels counted one by one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec._native import tile_segments
from sgicodec.errors import UsageError
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


def _shares(axis: Axis, start: int, scale: float, first: int, count: int) -> np.ndarray:
    """How much each tile gives to each output pixel [tiles, count]."""
    shares = np.zeros((axis.count, count))
    drawn = np.zeros(count, int)
    for begin, end, tile, weight in tile_segments(axis.length, axis.count, axis.apron, start, scale, first, count):
        assert end > begin
        drawn[begin:end] += 1
        shares[tile, begin:end] += 1 - np.asarray(0.0 if weight is None else weight)
        if weight is not None:
            shares[tile + 1, begin:end] += weight
    assert (drawn == 1).all()
    return shares


@given(grids())
def test_shares_sum_to_one_and_lie_inside_their_tiles(grid: TileGrid) -> None:
    axis = grid.across
    shares = _shares(axis, 0, 1.0, 0, axis.length)
    np.testing.assert_allclose(shares.sum(axis=0), 1, atol=1e-6)
    for tile in range(axis.count):
        begin, end = axis.extent(tile)
        assert not shares[tile, :begin].any()
        assert not shares[tile, end:].any()
        assert (shares[tile, begin:end] > 0).all()


def test_a_share_is_a_ramp() -> None:
    shares = _shares(Axis(64, 2, 4), 0, 1.0, 0, 64)
    expected = np.concatenate([np.zeros(28), (np.arange(8) + 0.5) / 8, np.ones(28)])
    np.testing.assert_allclose(shares[1], expected, atol=1e-6)


@given(grids(), st.data())
def test_a_part_has_the_shares_of_the_whole(grid: TileGrid, data: st.DataObject) -> None:
    axis = grid.across
    whole = _shares(axis, 0, 1.0, 0, axis.length)
    start = data.draw(st.integers(0, axis.length - 1))
    first = data.draw(st.integers(0, axis.length - start - 1))
    count = data.draw(st.integers(1, axis.length - start - first))
    part = _shares(axis, start, 1.0, first, count)
    np.testing.assert_array_equal(part, whole[:, start + first : start + first + count])


@given(grids(), st.sampled_from([0.05, 0.3, 1.7, 6.0]))
def test_a_scaled_view_is_covered(grid: TileGrid, scale: float) -> None:
    count = max(1, round(grid.width * scale))
    shares = _shares(grid.across, 0, scale, 0, count)
    np.testing.assert_allclose(shares.sum(axis=0), 1, atol=1e-6)
    centre = (np.arange(count) + 0.5) / scale
    for tile in range(grid.across.count):
        begin, end = grid.across.extent(tile)
        inside = (centre >= begin) & (centre < end)
        assert not shares[tile, ~inside & (centre < grid.width)].any()


def test_an_apron_is_at_most_a_quarter_of_the_tile() -> None:
    with pytest.raises(UsageError, match="apron of 17"):
        TileGrid(200, 200, 64, 17)
