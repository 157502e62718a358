"""The geometry of tiles, against pixels counted one by one."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.model.tile_grid import TileGrid


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
