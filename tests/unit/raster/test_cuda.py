"""The CUDA back end against the float64 dense sum, its kernels compiled for the host (tests/support/fake_cuda.cpp)."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from fake_cuda import backwards, fake_gpu
from scenes import Scene, backward, covariances_of, exact, gradient_magnitude, magnitude, random_scene, whitened

from sgicodec.errors import UsageError
from sgicodec.raster.backend import Background, Loss, Mapping, nothing_behind
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.cuda import CudaRasterizer
from sgicodec.raster.reference import ReferenceRasterizer, rasterize_reference, rasterize_reference_backward

FORWARD, BACKWARD = 4e-5, 8e-5  # rounding, relative to the sum of magnitudes
WIDE = 6.0  # cutoff at which what is left out is below rounding


def check(scene: Scene, width: int, height: int, origin: tuple[int, int] = (0, 0)) -> None:
    """Forward and backward of one scene."""
    raster = CudaRasterizer(fake_gpu(), WIDE)
    image = raster.forward(*scene, width, height, origin)
    assert (image.shape, image.dtype) == ((scene[2].shape[1], height, width), np.float32)
    error = np.abs(image - rasterize_reference(*exact(scene), width, height, origin))
    assert np.all(error <= FORWARD * (magnitude(scene, width, height, origin) + 0.02))

    grad = np.random.default_rng(1).normal(size=image.shape).astype(np.float32)
    gradients = backward(raster, scene, grad, origin)
    expected = rasterize_reference_backward(*exact(scene), grad.astype(np.float64), origin)
    error = np.abs(whitened(scene, gradients) - whitened(scene, expected))
    assert np.all(error <= BACKWARD * (gradient_magnitude(scene, grad, origin) + 0.1))


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_up_to_four_channels(channels: int) -> None:
    check(random_scene(np.random.default_rng(channels), 40, channels, 53, 37), 53, 37)


def test_five_channels_are_too_many() -> None:
    with pytest.raises(UsageError, match="up to 4"):
        CudaRasterizer(fake_gpu()).forward(*random_scene(np.random.default_rng(0), 3, 5, 9, 9), 9, 9)


@pytest.mark.parametrize("sigma", [0.3, 1.0, 7.0, 20.0])
def test_elongated_at_any_angle(sigma: float) -> None:
    angle = np.linspace(0, np.pi, 24, endpoint=False)
    rng = np.random.default_rng(int(10 * sigma))
    means = rng.uniform(-5, 90, (24, 2)).astype(np.float32)
    for ratio in (1.0, 10.0):
        shapes = covariances_of(np.full(24, sigma), np.full(24, ratio), angle).astype(np.float32)
        check((means, shapes, rng.normal(size=(24, 3)).astype(np.float32)), 90, 70)


@pytest.mark.parametrize("origin", [(-100, 33), (7, -50), (61, 90)])
@pytest.mark.parametrize("size", [(1, 1), (33, 17), (60, 45)])
def test_any_crop(size: tuple[int, int], origin: tuple[int, int]) -> None:
    means, covariances, colours = random_scene(np.random.default_rng(sum(size)), 30, 3, *size, ratio=10.0)
    check((means + np.float32(origin), covariances, colours), *size, origin)


def test_many_gaussians_of_one_tile_in_their_order() -> None:
    """More than a block stages at a time, and more than one block sorts."""
    rng = np.random.default_rng(8)
    scene = random_scene(rng, 700, 3, 40, 20, sigma=(0.5, 2.0))
    check(scene, 40, 20)
    raster = CudaRasterizer(fake_gpu())
    raster.forward(*scene, 40, 20)
    assert raster._drawn is not None
    passes = raster._drawn[1]
    assert passes.sort_blocks > 1
    slots, starts = passes._sorted.slots, passes.tile_start.download()
    sorted_slots = next(array for array in passes.pairs if array.address == slots).download()
    assert passes.found() == starts[-1]
    for first, last in itertools.pairwise(starts):
        assert (np.diff(sorted_slots[first:last].astype(np.int64)) > 0).all()


def test_a_picture_of_many_tiles() -> None:
    """Numbers of tiles of more than one digit."""
    scene = random_scene(np.random.default_rng(4), 300, 1, 700, 700, sigma=(0.5, 6.0))
    ours, cpu = CudaRasterizer(fake_gpu(), WIDE), NativeRasterizer(cutoff=WIDE)
    np.testing.assert_array_equal(ours.forward(*scene, 700, 700), cpu.forward(*scene, 700, 700))


def test_nothing_to_draw() -> None:
    empty = random_scene(np.random.default_rng(0), 0, 3, 1, 1)
    far = (np.full((1, 2), 1000, np.float32), np.array([[1, 0, 1]], np.float32), np.ones((1, 3), np.float32))
    for scene in (empty, far):
        raster = CudaRasterizer(fake_gpu())
        assert not raster.forward(*scene, 20, 10).any()
        gradients = backward(raster, scene, np.ones((3, 10, 20), np.float32))
        assert [g.shape for g in gradients] == [array.shape for array in scene]
        assert not any(g.any() for g in gradients)
        assert raster.error(*scene, np.ones((3, 10, 20), np.float32), weight=0.5)[0].loss == 300.0


def test_hostile_gaussians_are_left_out() -> None:
    means = np.array([[5, 5], [np.nan, 5], [5, np.inf], [5, 5], [5, 5]], np.float32)
    covariances = np.array([[4, 0, 4], [4, 0, 4], [4, 0, 4], [-1, 0, 4], [1, 2, 1]], np.float32)
    colours = np.ones((5, 1), np.float32)
    raster = CudaRasterizer(fake_gpu())
    image = raster.forward(means, covariances, colours, 11, 9)
    np.testing.assert_array_equal(
        image, CudaRasterizer(fake_gpu()).forward(means[:1], covariances[:1], colours[:1], 11, 9)
    )
    gradients = backward(raster, (means, covariances, colours), np.ones_like(image))
    assert not any(gradient[1:].any() for gradient in gradients)
    wide = (means[:1], covariances[:1] * np.float32(1e8), colours[:1])
    with pytest.raises(OverflowError):
        CudaRasterizer(fake_gpu(), most_pairs=100).forward(*wide, 800, 800)


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("loss", ["squared", "absolute"])
def test_error_in_one_pass(loss: Loss, weighted: bool) -> None:
    rng = np.random.default_rng(2)
    scene = random_scene(rng, 60, 3, 50, 40, sigma=(0.5, 6.0))
    target = rng.normal(size=(3, 40, 50)).astype(np.float32)
    weights = rng.uniform(0.1, 3, (40, 50)).astype(np.float32) if weighted else None
    found, gradients = CudaRasterizer(fake_gpu(), WIDE).error(*scene, target, loss, 0.7, weights)
    wide = None if weights is None else weights.astype(float)
    wanted, expected = ReferenceRasterizer().error(*exact(scene), target.astype(float), loss, 0.7, wide)
    assert found == pytest.approx(wanted, rel=1e-5)
    by_pixel = np.float32(0.7) * (1 if weights is None else weights)
    error = rasterize_reference(*exact(scene), 50, 40) - target
    grad = by_pixel * (2 * error if loss == "squared" else np.ones_like(error))
    difference = np.abs(whitened(scene, gradients) - whitened(scene, expected))
    assert np.all(difference <= 2 * BACKWARD * (gradient_magnitude(scene, grad) + 0.1))


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


def test_repeated_calls_give_the_same_bytes() -> None:
    scene = random_scene(np.random.default_rng(3), 200, 3, 64, 48)
    target = np.zeros((3, 48, 64), np.float32)
    (first, gradients), (second, again) = (CudaRasterizer(fake_gpu()).error(*scene, target) for _ in "ab")
    assert first == second
    for a, b in zip(gradients, again, strict=True):
        np.testing.assert_array_equal(a, b)


def test_no_thread_waits_for_what_another_does_in_the_same_phase() -> None:
    """A race between threads, or blocks, would show when they run in another order."""
    scene = random_scene(np.random.default_rng(13), 900, 3, 150, 90)
    target = np.random.default_rng(14).normal(size=(3, 90, 150)).astype(np.float32)
    first, gradients = CudaRasterizer(fake_gpu()).error(*scene, target)
    image = CudaRasterizer(fake_gpu()).forward(*scene, 150, 90)
    with backwards():
        second, again = CudaRasterizer(fake_gpu()).error(*scene, target)
        np.testing.assert_array_equal(image, CudaRasterizer(fake_gpu()).forward(*scene, 150, 90))
    assert first == second
    for a, b in zip(gradients, again, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("behind", ["planes", "lines", "both"])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_samples_on_a_background(dtype: type, behind: str) -> None:
    """As the processor makes them: clipped, mapped, rounded to nearest; not-a-number is 0."""
    rng = np.random.default_rng(9)
    scene = random_scene(rng, 30, 3, 24, 16)
    planes = rng.uniform(-1, 1, size=(3, 16, 24)).astype(np.float32)
    planes[1, 2, 3] = np.nan
    lines = rng.uniform(-1, 1, (3, 7, 24)).astype(np.float32), rng.integers(0, 4, 16).astype(np.int32)
    weights = rng.uniform(0, 1, (16, 4)).astype(np.float32)
    background = nothing_behind(3, planes) if behind == "planes" else Background(*lines, weights)
    background = background._replace(planes=planes) if behind == "both" else background
    top = {np.uint8: 255, np.uint16: 60000, np.float32: 2.5}[dtype]
    mapping = Mapping(np.array([0, 3, 0], np.float32) * (dtype != np.uint8), np.full(3, top, np.float32))
    held = np.zeros((2, 16, 30, 3), dtype)
    ours, cpu = held[:, :, :24]  # rows of a larger picture
    for raster, out in ((CudaRasterizer(fake_gpu(), WIDE), ours), (NativeRasterizer(cutoff=WIDE), cpu)):
        raster.draw(*scene, out, background=background, mapping=mapping)
    np.testing.assert_array_equal(ours, cpu)
    assert ours.std() > top / 25
    assert not held[:, :, 24:].any()
    whole = np.ascontiguousarray(ours)
    CudaRasterizer(fake_gpu(), WIDE).draw(*scene, whole, background=background, mapping=mapping)
    np.testing.assert_array_equal(whole, ours)


def test_values_as_they_are() -> None:
    scene = random_scene(np.random.default_rng(10), 30, 2, 24, 16)
    ours, cpu = np.empty((2, 16, 24, 2), np.float32)
    for raster, out in ((CudaRasterizer(fake_gpu(), WIDE), ours), (NativeRasterizer(cutoff=WIDE), cpu)):
        raster.draw(*scene, out)
    np.testing.assert_array_equal(ours, cpu)
    assert ours.min() < 0
    with pytest.raises(ValueError, match="float32"):
        CudaRasterizer(fake_gpu()).draw(*scene, np.empty((16, 24, 2), np.uint8))
