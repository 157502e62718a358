"""Samples of more bits than a stream holds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tifffile

from sgicodec import open_source


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
def test_that_types_change_is_said(dtype: str, note: str | None, tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "a.tif", np.arange(120).reshape(10, 12).astype(dtype))
    with open_source(tmp_path / "a.tif") as source:
        assert list(source.notes) == ([note] if note else [])
