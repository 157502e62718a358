"""The CUDA back end beside the processor's: order and bounds (test_backend.py has the float64 dense sum)."""

from __future__ import annotations

import numpy as np
import pytest
from fake_cuda import fake_gpu
from scenes import backward, random_scene

from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.cuda import CudaRasterizer

WIDE = 6.0  # cutoff at which what is left out is below rounding


def test_a_picture_of_many_tiles() -> None:
    """Numbers of tiles of more than one digit."""
    scene = random_scene(np.random.default_rng(4), 300, 1, 700, 700, sigma=(0.5, 6.0))
    ours, cpu = CudaRasterizer(fake_gpu(), WIDE), NativeRasterizer(cutoff=WIDE)
    np.testing.assert_array_equal(ours.forward(*scene, 700, 700), cpu.forward(*scene, 700, 700))


def test_pairs_are_bounded() -> None:
    wide = np.float32([[5, 5]]), np.float32([[4e8, 0, 4e8]]), np.ones((1, 1), np.float32)
    with pytest.raises(OverflowError):
        CudaRasterizer(fake_gpu(), most_pairs=100).forward(*wide, 800, 800)


def test_a_cutoff_is_the_same_forward_and_backward() -> None:
    """Finite differences of the colours, in which the rendered picture is linear: exact but for rounding."""
    rng = np.random.default_rng(6)
    scene = random_scene(rng, 20, 1, 40, 30, sigma=(1.0, 8.0), ratio=6.0)
    raster = CudaRasterizer(fake_gpu())
    grad = rng.normal(size=(1, 30, 40)).astype(np.float32)
    slopes = backward(raster, scene, grad)[2][:, 0]
    for i in range(20):
        alone = tuple(array[i : i + 1] for array in (scene[0], scene[1], np.ones((20, 1), np.float32)))
        image = CudaRasterizer(fake_gpu()).forward(*alone, 40, 30).astype(np.float64)
        assert slopes[i] == pytest.approx(float((image * grad).sum()), rel=1e-4, abs=1e-4)
