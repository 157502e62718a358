"""Atoms of texture, and cells that none may have; pixels are compared in tests/conformance/test_exact_pixels.py."""

from __future__ import annotations

import numpy as np
import pytest
from textures import texture_atoms

from sgicodec.model.texture import TextureLayer


def test_the_atoms_are_the_formula() -> None:
    """Term by term, at places on and between pixel centres."""
    t = np.array([-4.0, -3.9, 0.0, 2.2, 4.0, 9.5, 12.0, 17.0, 19.9, 20.0, 25.0])
    for k in (0, 5, 15):
        rise = np.where(t <= -4, 0, np.where(t < 4, np.sin(np.pi / 4 * (1 + t / 4)), 1))
        fall = np.where(16 - t <= -4, 0, np.where(16 - t < 4, np.sin(np.pi / 4 * (1 + (16 - t) / 4)), 1))
        expected = np.sqrt(2 / 16) * rise * fall * np.cos(np.pi * (k + 0.5) * t / 16)
        np.testing.assert_allclose(texture_atoms(t, 4)[:, k], expected, atol=1e-12)


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
