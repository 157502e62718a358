"""Selections of a chunk are those of the whole chunk's array."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import basic_indices

import sgicodec
from sgicodec.errors import CorruptStreamError, UsageError
from sgicodec.picture import equal_samples
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


@given(st.sampled_from([(8, 9), (8, 9, 1), (1, 8, 9), (1, 1, 8, 9, 3), (8, 9, 4), (8, 9, 2)]))
@settings(max_examples=6)
def test_shapes(shape: tuple[int, ...]) -> None:
    data = encode_chunk(np.full(shape, 77, np.uint8), None, {"steps": 1})
    assert decode_chunk(data, shape, UINT8).shape == shape
    with sgicodec.open(data) as stream:
        assert stream.header.channels in ("gray", "rgb", "multi")


def test_alpha_is_asked_for() -> None:
    with sgicodec.open(encode_chunk(np.full((8, 8, 4), 9, np.uint8), "rgba", {"steps": 1})) as stream:
        assert stream.header.channels == "rgba"


@pytest.mark.parametrize("shape", [(8,), (), (2, 8, 9, 3), (0, 4), (1, 0, 4, 3)])
def test_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(UsageError, match=r"must be \[y, x\] or \[y, x, c\]"):
        check_chunk(shape, UINT8)


def test_other_types_and_settings_are_refused() -> None:
    with pytest.raises(UsageError, match="chunks of int32"):
        check_chunk((8, 8), np.dtype(np.int32))
    with pytest.raises(UsageError, match="no setting 'qualty'"):
        checked_settings({"qualty": 3})
    with pytest.raises(UsageError):
        checked_settings({"quality": 300})


BANDS = {"sample_range": [[0, 10], [4095, 200]]}
SAMPLES: list[tuple[dict[str, Any], Any, dict[str, Any]]] = [
    ({"sample_range": "type"}, (0, 65535), {"sample_range": "type"}),
    ({"sample_range": "used"}, ((900, 20), (1000, 99)), {"sample_range": "used"}),
    ({"sample_range": (0, 4095)}, (0, 4095), {"sample_range": [0, 4095]}),
    (
        {"sample_range": ((0, 10), (4095, np.uint16(200)))},
        ((0, 10), (4095, 200)),
        {"sample_range": [[0, 10], [4095, 200]]},
    ),
    (
        {"sample_range": (np.array([0, 10]), [4095, 200])},
        ((0, 10), (4095, 200)),
        {"sample_range": [[0, 10], [4095, 200]]},
    ),
]


@pytest.mark.parametrize(("given", "sample_range", "stored"), SAMPLES)
def test_ranges_survive_json(given: dict[str, Any], sample_range: Any, stored: dict[str, Any]) -> None:
    chunk = np.empty((16, 20, 2), np.uint16)
    chunk[..., 0], chunk[..., 1] = np.linspace(900, 1000, 20), np.linspace(20, 99, 20)
    found = checked_settings(given | {"steps": 1})
    again = json.loads(json.dumps(found, allow_nan=False))
    assert again == found == stored | {"steps": 1}
    assert checked_settings(again) == found
    with sgicodec.open(encode_chunk(chunk, "multi", again)) as stream:
        assert stream.header.sample_range == sample_range


@pytest.mark.parametrize(
    ("nodata", "stored"), [(float("nan"), "NaN"), (np.float32("nan"), "NaN"), (-9999, -9999), (np.float32(-0.5), -0.5)]
)
def test_nodata_survives_json(nodata: float, stored: object) -> None:
    chunk = np.tile(np.linspace(0, 1, 20, dtype=np.float32), (16, 1))
    chunk[3:6] = nodata
    found = checked_settings({"nodata": nodata, "steps": 1})
    again = json.loads(json.dumps(found, allow_nan=False))
    assert again == found == {"nodata": stored, "steps": 1}
    decoded = decode_chunk(encode_chunk(chunk, None, again), chunk.shape, chunk.dtype)
    np.testing.assert_array_equal(equal_samples(decoded, nodata), equal_samples(chunk, nodata))


@pytest.mark.parametrize("wrong", [{"nodata": "none"}, {"sample_range": "all"}, {"sample_range": [1]}, {"nodata": [1]}])
def test_samples_that_make_no_sense_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match="nodata is a number"):
        checked_settings(wrong)


def test_a_chunk_of_another_shape_is_damage() -> None:
    with pytest.raises(CorruptStreamError, match=r"uint8 \(20, 26, 3\), where uint8 \(20, 26\)"):
        decode_chunk(DATA, (20, 26), UINT8)
    with pytest.raises(CorruptStreamError):
        decode_chunk(DATA, SHAPE, np.dtype(np.uint16))
