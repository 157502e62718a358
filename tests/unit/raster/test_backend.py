"""Every instruction set of the processor, and CUDA with its kernels compiled for the host (fake_cuda.cpp), against the
float64 dense sum; what is no Gaussian, and Gaussians of any size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from examples import examples
from fake_cuda import fake_gpu
from hypothesis import example, given, settings
from hypothesis import strategies as st
from reference_raster import ReferenceRasterizer, rasterize_reference, rasterize_reference_backward
from scenes import ISAS, Scene, backward, covariances_of, exact, gradient_magnitude, magnitude, random_scene, whitened

from sgicodec.device import Device
from sgicodec.errors import UsageError
from sgicodec.raster.backend import Loss
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.cuda import CudaRasterizer

FORWARD, BACKWARD = 4e-5, 8e-5  # rounding, relative to the sum of magnitudes
WIDE = 6.0  # cutoff at which what is left out is below rounding: exp(−18) = 1.5e-8
BACKENDS = [*ISAS, "cuda"]

every_backend = pytest.mark.parametrize("backend", BACKENDS)


def raster_of(backend: str, cutoff: float = WIDE) -> Any:
    return CudaRasterizer(fake_gpu(), cutoff) if backend == "cuda" else NativeRasterizer(Device(2, backend), cutoff)


def check(scene: Scene, width: int, height: int, origin: tuple[int, int], backend: str, seed: int = 0) -> None:
    """Forward, backward and the fused pass of one scene."""
    raster = raster_of(backend)
    image = raster.forward(*scene, width, height, origin)
    channels = scene[2].shape[1]
    assert (image.shape, image.dtype) == ((channels, height, width), np.float32)
    error = np.abs(image - rasterize_reference(*exact(scene), width, height, origin))
    assert np.all(error <= FORWARD * (magnitude(scene, width, height, origin) + 0.02))

    grad = np.random.default_rng(seed).normal(size=image.shape).astype(np.float32)
    gradients = backward(raster, scene, grad, origin)
    expected = rasterize_reference_backward(*exact(scene), grad.astype(np.float64), origin)
    error = np.abs(whitened(scene, gradients) - whitened(scene, expected))
    assert np.all(error <= BACKWARD * (gradient_magnitude(scene, grad, origin) + 0.1))


@every_backend
@pytest.mark.parametrize("channels", [1, 2, 3, 4, 6])
def test_any_number_of_channels(backend: str, channels: int) -> None:
    scene = random_scene(np.random.default_rng(channels), 40, channels, 53, 37)
    if backend == "cuda" and channels > 4:
        with pytest.raises(UsageError, match="up to 4"):
            check(scene, 53, 37, (0, 0), backend)
    else:
        check(scene, 53, 37, (0, 0), backend)


@every_backend
@pytest.mark.parametrize("sigma", [0.3, 0.5, 1.0, 2.5, 7.0, 20.0])
def test_elongated_at_any_angle(backend: str, sigma: float) -> None:
    angle = np.linspace(0, np.pi, 24, endpoint=False)
    rng = np.random.default_rng(int(10 * sigma))
    means = rng.uniform(-5, 150, (24, 2)).astype(np.float32)
    for ratio in (1.0, 4.0, 10.0):
        shapes = covariances_of(np.full(24, sigma), np.full(24, ratio), angle).astype(np.float32)
        check((means, shapes, rng.normal(size=(24, 3)).astype(np.float32)), 150, 70, (0, 0), backend)


@every_backend
def test_many_gaussians_of_one_tile(backend: str) -> None:
    """More than a block of a GPU stages at a time, and more than one block sorts."""
    check(random_scene(np.random.default_rng(8), 700, 3, 40, 20, sigma=(0.5, 2.0)), 40, 20, (0, 0), backend)


@settings(max_examples=examples(40))
@given(
    st.integers(1, 60),
    st.integers(1, 60),
    st.tuples(st.integers(-100, 100), st.integers(-100, 100)),
    st.integers(0, 12),
    st.sampled_from([1, 2, 3, 4, 6]),
    st.sampled_from(BACKENDS),
    st.integers(0, 2**32 - 1),
)
def test_any_crop(
    width: int, height: int, origin: tuple[int, int], count: int, channels: int, backend: str, seed: int
) -> None:
    channels = min(channels, 4) if backend == "cuda" else channels
    means, covariances, colours = random_scene(np.random.default_rng(seed), count, channels, width, height, ratio=10.0)
    check((means + np.float32(origin), covariances, colours), width, height, origin, backend, seed)


@every_backend
def test_nothing_to_draw(backend: str) -> None:
    empty = random_scene(np.random.default_rng(0), 0, 3, 1, 1)
    far = (np.full((1, 2), 1000, np.float32), np.array([[1, 0, 1]], np.float32), np.ones((1, 3), np.float32))
    for scene in (empty, far):
        raster = raster_of(backend, 3.5)
        assert not raster.forward(*scene, 20, 10).any()
        assert backend == "cuda" or raster.tile_pairs == 0
        gradients = backward(raster, scene, np.ones((3, 10, 20), np.float32))
        assert [g.shape for g in gradients] == [array.shape for array in scene]
        assert not any(g.any() for g in gradients)
        assert raster.error(*scene, np.ones((3, 10, 20), np.float32), weight=0.5)[0].loss == 300.0


@every_backend
@pytest.mark.parametrize("channels", [1, 3, 6])
@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("loss", ["squared", "absolute"])
def test_error_is_that_of_the_reference(loss: Loss, weighted: bool, channels: int, backend: str) -> None:
    """A wide cutoff, so that what is left out is below rounding."""
    channels = min(channels, 4) if backend == "cuda" else channels
    rng = np.random.default_rng(channels)
    scene = random_scene(rng, 60, channels, 70, 45, sigma=(0.5, 6.0), ratio=4.0)
    target = rng.normal(size=(channels, 45, 70)).astype(np.float32)
    weights = rng.uniform(0.1, 3.0, (45, 70)).astype(np.float32) if weighted else None
    for origin in ((0, 0), (-7, 21)):
        raster = raster_of(backend, 7.0)
        found, gradients = raster.error(*scene, target, loss, 0.3, weights, origin)
        wide = None if weights is None else weights.astype(np.float64)
        expected, exact_gradients = ReferenceRasterizer().error(
            *exact(scene), target.astype(np.float64), loss, 0.3, wide, origin
        )
        assert found == pytest.approx(expected, rel=1e-6)
        for one, two in zip(gradients, exact_gradients, strict=True):
            np.testing.assert_allclose(one, two, atol=2e-4 * np.abs(two).max())


@every_backend
def test_absolute_error_has_no_slope_where_nothing_differs(backend: str) -> None:
    """Pixels that agree count nothing, in whole vectors and beside them."""
    means, covariances, _ = random_scene(np.random.default_rng(4), 60, 3, 70, 45, sigma=(0.5, 6.0))
    nothing = np.zeros((3, 45, 70), np.float32)
    raster = raster_of(backend)
    found, gradients = raster.error(means, covariances, np.zeros((60, 3), np.float32), nothing, "absolute")
    assert found == (0.0, 0.0)
    assert not any(gradient.any() for gradient in gradients)


BAD = [np.nan, np.inf, -np.inf, 3e38, -3e38, 1e-45, 0.0, -1.0]


@every_backend
def test_what_is_no_gaussian_does_no_harm(backend: str) -> None:
    good = random_scene(np.random.default_rng(6), 5, 3, 40, 30, sigma=(1.0, 5.0))
    bad_means = [(value, 10.0) for value in BAD[:3]] + [(10.0, value) for value in BAD[:3]]
    bad_shapes = [(value, 0.0, 2.0) for value in BAD[:3] + BAD[-2:]] + [
        (2.0, 0.0, value) for value in BAD[:3] + BAD[-2:]
    ]
    bad_shapes += [(2.0, value, 2.0) for value in BAD[:5]] + [(4.0, 2.0, 1.0), (1.0, 5.0, 1.0), (-1.0, 0.0, -1.0)]
    count = len(bad_means) + len(bad_shapes)
    means = np.array(bad_means + [(10.0, 10.0)] * len(bad_shapes), np.float32)
    shapes = np.array([(2.0, 0.0, 2.0)] * len(bad_means) + bad_shapes, np.float32)
    at = np.arange(5) * count // 5  # the good ones in between
    mixed = (
        np.insert(means, at, good[0], axis=0),
        np.insert(shapes, at, good[1], axis=0),
        np.insert(np.ones((count, 3), np.float32), at, good[2], axis=0),
    )
    kept = at + np.arange(5)
    raster, alone = raster_of(backend, 3.5), raster_of(backend, 3.5)
    np.testing.assert_array_equal(raster.forward(*mixed, 40, 30), alone.forward(*good, 40, 30))
    grad = np.ones((3, 30, 40), np.float32)
    for gradient, expected in zip(backward(raster, mixed, grad), backward(alone, good, grad), strict=True):
        np.testing.assert_array_equal(gradient[kept], expected)
        assert not np.delete(gradient, kept, axis=0).any()


number = st.one_of(st.sampled_from(BAD), st.floats(width=32), st.floats(-50, 50, width=32))


@settings(max_examples=examples(200))
@example([(3e38, -3e38, 1.0, 1e-45, 3e38)], "portable", (0, 0))  # its moments are infinite
@given(
    st.lists(st.tuples(number, number, number, number, number), min_size=1, max_size=6),
    st.sampled_from(ISAS),
    st.sampled_from([(0, 0), (2**30 - 20, 1 - 2**30), (-7, 1000)]),
)
@example([(1.0, 1e-45, 1e-45, 1e-45, 1.0)], "portable", (0, 0))
def test_any_numbers_end_in_finite_images_and_gradients(
    rows: list[tuple[float, ...]], isa: str, origin: tuple[int, int]
) -> None:
    table = np.array(rows, np.float32)
    colours = np.ones((len(rows), 1), np.float32)
    means, covariances = np.ascontiguousarray(table[:, :2]), np.ascontiguousarray(table[:, 2:])
    raster = NativeRasterizer(Device(1, isa))
    image = raster.forward(means, covariances, colours, 20, 20, origin)
    assert np.all((image >= 0) & (image <= len(rows) + 1e-3))
    for gradient in backward(raster, (means, covariances, colours), np.ones((1, 20, 20), np.float32), origin):
        assert np.isfinite(gradient).all()


@pytest.mark.parametrize("isa", ISAS)
def test_huge_gaussians_cover_everything(isa: str) -> None:
    means = np.array([[0, 0], [1e9, -1e9], [-1e30, 1e30]], np.float32)
    covariances = np.array([[1e30, 0, 1e30], [1e30, 1e29, 1e30], [1e38, 0, 1e38]], np.float32)
    colours = np.array([[1.0], [0.5], [0.25]], np.float32)
    image = NativeRasterizer(Device(2, isa)).forward(means, covariances, colours, 700, 500)
    np.testing.assert_allclose(image, 1.5, rtol=1e-5)  # the third lies 1e11 deviations away


def test_a_picture_of_many_tiles_on_a_gpu() -> None:
    """Numbers of tiles of more than one digit."""
    scene = random_scene(np.random.default_rng(4), 300, 1, 700, 700, sigma=(0.5, 6.0))
    ours, cpu = CudaRasterizer(fake_gpu(), WIDE), NativeRasterizer(cutoff=WIDE)
    np.testing.assert_array_equal(ours.forward(*scene, 700, 700), cpu.forward(*scene, 700, 700))


def test_pairs_are_bounded_on_a_gpu() -> None:
    wide = np.float32([[5, 5]]), np.float32([[4e8, 0, 4e8]]), np.ones((1, 1), np.float32)
    with pytest.raises(OverflowError):
        CudaRasterizer(fake_gpu(), most_pairs=100).forward(*wide, 800, 800)


def test_a_cutoff_on_a_gpu_is_the_same_forward_and_backward() -> None:
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
