from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.errors import PictureError
from sgicodec.image.extremes import Extremes

SAMPLES = st.lists(st.floats(-1e6, 1e6, width=32), min_size=2, max_size=20)


@given(samples=SAMPLES, parts=st.integers(1, 5), holes=st.sampled_from([None, -9999.0, float("nan")]))
def test_parts_give_the_extremes_of_the_whole(samples: list[float], parts: int, holes: float | None) -> None:
    found = Extremes("gray", holes)
    kept = [value for value in samples if value != holes]
    mixed = kept if holes is None else [*kept, holes, holes]
    for part in np.array_split(np.array(mixed, np.float32), parts):
        found.add(part.reshape(1, -1, 1))
    low, high = found.range()
    if not kept:
        assert (low, high) == (0.0, 1.0)
    else:
        assert low == min(kept)
        assert high == max(kept) if min(kept) < max(kept) else high > low


def test_alpha_does_not_count() -> None:
    found = Extremes("rgba", None)
    found.add(np.array([[[2.0, 3.0, 4.0, 99.0]]], np.float32))
    assert found.range() == (2.0, 4.0)


@pytest.mark.parametrize("value", [np.inf, -np.inf])
def test_infinite_samples(value: float) -> None:
    pixels = np.array([[[value], [1.0]]], np.float32)
    with pytest.raises(PictureError, match="infinite"):
        Extremes("gray", None).add(pixels)
    found = Extremes("gray", value)
    found.add(pixels)
    assert found.range() == (1.0, 2.0)


def test_extremes_farther_apart_than_floats_tell() -> None:
    found = Extremes("gray", None)
    found.add(np.array([-1.7e38, 1.8e38], np.float32).reshape(1, 2, 1))
    with pytest.raises(PictureError, match="farther apart than floats"):
        found.range()
