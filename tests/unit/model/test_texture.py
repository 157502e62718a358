"""The texture layer against dense sums in float64."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import ISAS
from textures import random_symbols, texture_atoms

from sgicodec.device import Device
from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.texture import TextureLayer

WIDTH, HEIGHT = 150, 70


def axis_atoms(length: int, corner: int, log_size: int, places: np.ndarray) -> np.ndarray:
    side = 1 << log_size
    return texture_atoms(places - corner, log_size, (corner == 0, corner + side == -(-length // 32) * 32))


def dense(layer: TextureLayer, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The layer [C, h, w] at places x [w], y [h], in opponent colours."""
    total, at = np.zeros((layer.channels, len(y), len(x))), 0
    for (left, top), log in zip(layer.corner.tolist(), layer.log_size.tolist(), strict=True):
        side = 1 << log
        amplitudes = layer.amplitudes[at : at + layer.channels * side * side].reshape(-1, side, side)
        across, down = axis_atoms(layer.size[0], left, log, x), axis_atoms(layer.size[1], top, log, y)
        total += down @ amplitudes.astype(np.float64) @ across.T
        at += amplitudes.size
    assert at == len(layer.amplitudes)
    return total


def test_the_atoms_are_the_formula() -> None:
    """Term by term, at places on and between pixel centres."""
    t = np.array([-4.0, -3.9, 0.0, 2.2, 4.0, 9.5, 12.0, 17.0, 19.9, 20.0, 25.0])
    for k in (0, 5, 15):
        rise = np.where(t <= -4, 0, np.where(t < 4, np.sin(np.pi / 4 * (1 + t / 4)), 1))
        fall = np.where(16 - t <= -4, 0, np.where(16 - t < 4, np.sin(np.pi / 4 * (1 + (16 - t) / 4)), 1))
        expected = np.sqrt(2 / 16) * rise * fall * np.cos(np.pi * (k + 0.5) * t / 16)
        np.testing.assert_allclose(texture_atoms(t, 4)[:, k], expected, atol=1e-12)


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize("channels", [1, 3, 5])
def test_pixels_are_the_dense_sum(isa: str, channels: int) -> None:
    """Other places and scales are those of decoders (tests/conformance/test_exact_pixels.py)."""
    symbols = random_symbols(channels, WIDTH, HEIGHT)
    layer = replace(symbols, steps=replace(symbols.steps, step=300)).layer()
    expected = dense(layer, np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    mixed = np.tensordot(np.array(colour_matrix(channels)).T, expected, axes=1)
    np.testing.assert_allclose(layer.draw(Device(2, isa)), mixed, atol=1e-6)


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
