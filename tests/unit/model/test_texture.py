"""Cells of texture that none may have; tests/conformance/test_exact_pixels.py compares pixels."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.model.texture import TextureLayer


@pytest.mark.parametrize(
    ("corner", "log_size", "values"),
    [((0, 0), 2, 16), ((0, 0), 6, 4096), ((4, 0), 3, 64), ((0, -8), 3, 64), ((64, 0), 3, 64), ((0, 0), 3, 63)],
)
def test_other_cells_are_refused(corner: tuple[int, int], log_size: int, values: int) -> None:
    layer = TextureLayer(
        (64, 64), 1, np.array([corner], np.int32), np.array([log_size], np.uint8), np.zeros(values, np.float32)
    )
    with pytest.raises(ValueError, match=r"corner|log_size|amplitudes"):
        layer.draw()
