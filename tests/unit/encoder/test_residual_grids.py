"""Grids of residual layers: no sample is off by more than was asked for."""

from __future__ import annotations

import numpy as np
import pytest
from page_varint import decode_varint

from sgicodec import EncodeSettings, Picture
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.residual_grids import residual_form


@pytest.mark.parametrize("max_error", range(12))
@pytest.mark.parametrize("last", [1, 7, 20, 100, 251, 255])
def test_a_coarse_grid_is_near_all_samples(max_error: int, last: int) -> None:
    values = np.minimum(np.arange(256), last).astype(np.uint8)
    pixels = np.repeat(np.repeat(values, 4)[None, :, None], 2, axis=0)  # most are as the one to their left
    header = stream_plan(Shape.of(Picture(pixels, "gray", (0.0, 255.0))), EncodeSettings()).header
    form = residual_form(header, [pixels], max_error)
    base, step = np.frombuffer(form[9:25], "<f8")
    most, at = decode_varint(form, 25)
    assert decode_varint(form, at)[0] == 0
    grid = base + step * np.arange(most + 1)
    assert 0 <= grid.min() <= grid.max() <= last
    assert np.abs(values[:, None] - grid).min(axis=1).max() <= max_error
