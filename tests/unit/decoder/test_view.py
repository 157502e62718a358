"""What a view asks for: its size, what of an overview that is, and what an index touches, as numpy's own indexing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import basic_indices

from sgicodec._native import overview_view
from sgicodec.bitstream.header import Header
from sgicodec.decoder.indexing import indexed_region
from sgicodec.decoder.view import Region, View, overview_size, view_of
from sgicodec.errors import RegionError, UsageError
from sgicodec.profiles.default import default_spec

TILED = Header(4096, 3000, "rgb", "uint8", (0, 255), "default", default_spec(3), 40, 0, tile=1024, apron=8)


def test_a_sixteenth_and_less_is_what_an_overview_shows() -> None:
    """It has 256×188 pixels. Regions may begin between two of them, and round up where they end, but not from less than
    half a pixel.
    """

    def shown(region: Region | None, scale: float | None, size: tuple[int, int] | None = None) -> View | None:
        found = overview_view(view_of(TILED, region, scale, size), TILED.width, TILED.height)
        return None if found is None else View(*found)

    assert view_of(TILED, None, 1e-9, None) == View(0, 0, 1 / 4096, 1 / 3000, 1, 1)
    assert overview_size(4096, 3000) == (256, 188)
    assert overview_size(5, 24) == (1, 2)
    assert shown(None, 1 / 16) == View(0, 0, 1, 1, 256, 188)
    assert shown(None, None, (257, 188)) is None
    assert shown(None, None, (256, 189)) is None
    assert tuple(shown((8, 0, 824, 750), 1 / 16) or ()) == pytest.approx((0.5, 0, 52 / 51.5, 1, 52, 47))
    assert shown((8, 0, 824, 750), None, (53, 47)) is None
    assert shown((100, 50, 1, 1), None) is shown((96, 48, 7, 16), None, (1, 1)) is None
    assert shown((96, 48, 8, 16), None, (1, 1)) == View(6, 48 * 188 / 3000, 2, 3000 / 188 / 16, 1, 1)
    assert tuple(shown((1000, 300, 640, 480), 1 / 32) or ()) == pytest.approx((62.5, 18.8, 0.5, 15 / 30.08, 20, 15))


SHAPE = (7, 9, 3)


@given(key=basic_indices(SHAPE, allow_newaxis=False), gray=st.booleans())
def test_the_region_and_what_is_taken_from_it_make_the_index(key: object, gray: bool) -> None:
    array = np.arange(np.prod(SHAPE)).reshape(SHAPE)
    array = array[..., 0] if gray else array
    try:
        expected = array[key]  # type: ignore[index]
    except IndexError:
        with pytest.raises(IndexError):
            indexed_region(key, array.shape)
        return
    (x, y, width, height), inner = indexed_region(key, array.shape)
    assert 0 <= x <= x + width <= 9
    assert 0 <= y <= y + height <= 7
    np.testing.assert_array_equal(array[y : y + height, x : x + width][inner], expected)


@pytest.mark.parametrize("key", [7, -8, (0, 9), (0, 0, 3), (0, 0, 0, 0), (..., ...)])
def test_outside(key: object) -> None:
    with pytest.raises(RegionError) as found:
        indexed_region(key, SHAPE)
    assert isinstance(found.value, IndexError)


@pytest.mark.parametrize("key", [None, "red", 1.5, True, [1, 2], np.ones(7, bool), np.s_[::0], np.s_["a":]])
def test_what_is_no_integer_or_slice(key: object) -> None:
    with pytest.raises(UsageError):
        indexed_region(key, SHAPE)
