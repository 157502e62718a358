"""The texture layer against dense sums in float64."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import ISAS
from textures import random_layer, texture_atoms

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


def centres(count: int, start: float = 0.0, scale: float = 1.0, first: int = 0) -> np.ndarray:
    return start + (first + np.arange(count) + 0.5) / scale


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
@pytest.mark.parametrize(
    ("start", "scale", "first", "size"),
    [
        ((0.0, 0.0), (1.0, 1.0), (0, 0), (WIDTH, HEIGHT)),
        ((7.0, 3.0), (1.0, 1.0), (-5, 30), (190, 31)),
        ((0.25, 0.0), (1.0, 2.5), (0, 1), (WIDTH, 99)),
        ((33.5, 20.0), (17.0, 1.3), (40, 0), (301, 50)),
    ],
)
def test_pixels_are_the_dense_sum(
    isa: str,
    channels: int,
    start: tuple[float, float],
    scale: tuple[float, float],
    first: tuple[int, int],
    size: tuple[int, int],
) -> None:
    layer = random_layer(channels, WIDTH, HEIGHT)
    x, y = (centres(size[axis], start[axis], scale[axis], first[axis]) for axis in (0, 1))
    drawn = layer.draw(start, scale, first, size, Device(2, isa), opponent=True)
    expected = dense(layer, x, y)
    np.testing.assert_allclose(drawn, expected, atol=1e-6)
    mixed = np.tensordot(np.array(colour_matrix(channels)).T, expected, axes=1)
    np.testing.assert_allclose(layer.draw(start, scale, first, size, Device(2, isa)), mixed, atol=1e-6)


@pytest.mark.parametrize("scale", [(0.7, 0.5), (0.99, 0.2), (0.05, 1.0)])
def test_smaller_pictures_are_convolved_as_gaussians_are(scale: tuple[float, float]) -> None:
    """Against sums over places a sixteenth of a pixel apart, weighted as what a pixel covers beyond one."""
    layer = random_layer(1, 224, 64)
    size = int(224 * scale[0]), int(64 * scale[1])
    fine = (np.arange(224 * 16) + 0.5) / 16, (np.arange(64 * 16) + 0.5) / 16
    image = dense(layer, *fine)[0]
    for axis in (1, 0):
        sigma = np.sqrt(0.1 * (1 - scale[axis] ** 2)) / scale[axis]
        far = centres(size[axis], 0, scale[axis])[:, None] - fine[axis]
        weights = np.exp(-0.5 * (far / sigma) ** 2) if sigma > 0 else (np.abs(far) < 1 / 16).astype(np.float64)
        weights /= weights.sum(axis=1, keepdims=True)
        image = image @ weights.T if axis == 0 else weights @ image
    drawn = layer.draw(scale=scale, size=size)[0]
    error = np.abs(drawn - image) / np.std(image)
    assert np.sqrt(np.mean(error**2)) < 0.03  # more at the borders
    assert error[2:-2, 2:-2].max() < 0.05


@pytest.mark.parametrize("scale", [1.0, 0.4, 3.3, 0.03])
@pytest.mark.parametrize("isa", ISAS)
def test_regions_and_threads_change_no_bit(scale: float, isa: str) -> None:
    layer = random_layer(3, 400, 210, seed=3)
    size = max(3, int(400 * scale)), max(3, int(210 * scale))
    whole = layer.draw((3.0, 1.0), (scale, scale), (0, 0), size, Device(1, isa))
    for left, top, right, bottom in ((0, 0, *size), (1, 1, *size), (size[0] // 3, size[1] // 2, size[0] - 1, size[1])):
        part = right - left, bottom - top
        block = layer.draw((3.0, 1.0), (scale, scale), (left, top), part, Device(3, isa))
        np.testing.assert_array_equal(block, whole[:, top:bottom, left:right])
    if scale == 1:
        np.testing.assert_array_equal(layer.draw(first=(3, 1), size=size, device=Device(2, isa)), whole)


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
