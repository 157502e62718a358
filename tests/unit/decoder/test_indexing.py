"""What an index touches, against numpy's own indexing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import basic_indices

from sgicodec.decoder.indexing import indexed_region
from sgicodec.errors import RegionError, UsageError

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


def test_no_more_than_the_index_spans_is_touched() -> None:
    assert indexed_region(np.s_[2:5, ::4], SHAPE)[0] == (0, 2, 9, 3)
    assert indexed_region(np.s_[-1, 6:1:-2, 0], SHAPE)[0] == (2, 6, 5, 1)
    assert indexed_region(np.s_[4:4], SHAPE)[0] == (0, 0, 9, 0)


@pytest.mark.parametrize("key", [7, -8, (0, 9), (0, 0, 3), (0, 0, 0, 0), (..., ...)])
def test_outside(key: object) -> None:
    with pytest.raises(RegionError) as found:
        indexed_region(key, SHAPE)
    assert isinstance(found.value, IndexError)


@pytest.mark.parametrize("key", [None, "red", 1.5, True, [1, 2], np.ones(7, bool), np.s_[::0], np.s_["a":]])
def test_what_is_no_integer_or_slice(key: object) -> None:
    with pytest.raises(UsageError):
        indexed_region(key, SHAPE)
