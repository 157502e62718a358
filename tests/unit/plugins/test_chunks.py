"""Selections of a chunk are those of the whole chunk's array."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis.extra.numpy import basic_indices

import sgicodec
from sgicodec.errors import UsageError
from sgicodec.plugins.chunks import check_chunk, checked_settings, decode_chunk, encode_chunk, read_selection

SHAPE = (1, 20, 26, 3)
CHUNK = np.random.default_rng(5).integers(0, 256, SHAPE, np.uint8)
DATA = encode_chunk(CHUNK, None, {"steps": 3})
UINT8 = np.dtype(np.uint8)
WHOLE = decode_chunk(DATA, SHAPE, UINT8)


@settings(max_examples=examples(100))
@given(basic_indices(SHAPE, allow_newaxis=False, allow_ellipsis=False))
def test_basic_selections(selection: Any) -> None:
    with sgicodec.open(DATA) as stream:
        found = read_selection(stream, SHAPE, UINT8, selection)
    np.testing.assert_array_equal(found, WHOLE[selection])


@pytest.mark.parametrize("key", [np.array([1, 5, 2]), slice(18, 3, -4), slice(None, None, -1), 7])
def test_other_selections(key: Any) -> None:
    selection = (slice(None), slice(2, 9), key, slice(0, 2))
    with sgicodec.open(DATA) as stream:
        np.testing.assert_array_equal(read_selection(stream, SHAPE, UINT8, selection), WHOLE[selection])


def test_other_types_and_settings_are_refused() -> None:
    with pytest.raises(UsageError, match="chunks of int32"):
        check_chunk((8, 8), np.dtype(np.int32))
    with pytest.raises(UsageError, match="no setting 'qualty'"):
        checked_settings({"qualty": 3})
    with pytest.raises(UsageError):
        checked_settings({"quality": 300})
