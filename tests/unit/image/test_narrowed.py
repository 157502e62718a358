"""Samples that become floats of 32 bits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sgicodec.image.narrowed import narrowed


@pytest.mark.parametrize(
    ("samples", "nodata"),
    [
        (np.array([16777216, 16777217, 16777215], np.int32), 16777216.0),
        (np.array([4294967295, 4294967290, 7], np.uint32), 4294967295.0),
        (np.array([0.1, 0.1 + 1e-10, 0.1 - 1e-10]), 0.1),
        (np.array([-1.7976931348623157e308, -1e300, 1.0]), -1.79769313486232e308),  # as GDAL writes the least
    ],
)
def test_only_nodata_becomes_nodata(samples: np.ndarray[Any, Any], nodata: float) -> None:
    with np.errstate(over="ignore"):
        blank = np.float32(nodata)
    narrow, off = narrowed(samples, nodata)
    assert narrow.dtype == np.float32
    assert (narrow == blank).tolist() == [True, False, False]
    assert off > 0
    others = narrow[1:].astype(np.float64)
    assert ((others > blank) == (samples[1:] > blank)).all()


def test_what_is_not_finite_is_not_off() -> None:
    narrow, off = narrowed(np.array([np.nan, np.inf, 0.5]), float("nan"))
    np.testing.assert_array_equal(narrow, np.array([np.nan, np.inf, 0.5], np.float32))
    assert off == 0.0
