"""Samples of more bits than a stream holds."""

from __future__ import annotations

import numpy as np
import pytest
from image_files import by_tifffile, notes_of


@pytest.mark.parametrize(
    ("dtype", "note"),
    [
        ("uint8", None),
        ("uint16", None),
        ("float16", None),
        ("float32", None),
        ("int8", "samples of int8 become 32-bit floats"),
        ("int16", "samples of int16 become 32-bit floats"),
        ("uint32", "samples of uint32 become 32-bit floats, rounded to 24 bits"),
        ("float64", "samples of float64 become 32-bit floats, rounded to 24 bits"),
    ],
)
def test_that_types_change_is_said(dtype: str, note: str | None) -> None:
    data = by_tifffile(np.arange(120).reshape(10, 12).astype(dtype))
    assert notes_of(data) == ((note,) if note else ())
