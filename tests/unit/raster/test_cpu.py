"""Every instruction set of the native back end against the float64 dense sum."""

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import (
    ISAS,
    Scene,
    backward,
    covariances_of,
    exact,
    gradient_magnitude,
    magnitude,
    random_scene,
    values_of,
    whitened,
)

from sgicodec.device import Device
from sgicodec.raster.backend import Loss
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.reference import ReferenceRasterizer, rasterize_reference, rasterize_reference_backward

FORWARD, BACKWARD = 4e-5, 8e-5  # rounding, relative to the sum of magnitudes
WIDE = 6.0  # cutoff at which what is left out is below rounding: exp(−18) = 1.5e-8

every_isa = pytest.mark.parametrize("isa", ISAS)


def check(scene: Scene, width: int, height: int, origin: tuple[int, int], isa: str, seed: int = 0) -> None:
    """The image and the gradients of one scene."""
    raster = NativeRasterizer(Device(2, isa), WIDE)
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


def test_at_least_one_instruction_set_is_tested() -> None:
    assert "portable" in ISAS
    assert NativeRasterizer().isa == ISAS[0]  # auto takes the widest


@every_isa
@pytest.mark.parametrize("channels", [1, 2, 3, 4, 6])
def test_any_number_of_channels(isa: str, channels: int) -> None:
    rng = np.random.default_rng(channels)
    check(random_scene(rng, 40, channels, 53, 37), 53, 37, (0, 0), isa)


@every_isa
@pytest.mark.parametrize("sigma", [0.3, 0.5, 1.0, 2.5, 7.0, 20.0])
def test_elongated_at_any_angle(isa: str, sigma: float) -> None:
    angle = np.linspace(0, np.pi, 24, endpoint=False)
    rng = np.random.default_rng(int(10 * sigma))
    means = rng.uniform(-5, 150, (24, 2)).astype(np.float32)
    for ratio in (1.0, 4.0, 10.0):
        shapes = covariances_of(np.full(24, sigma), np.full(24, ratio), angle).astype(np.float32)
        check((means, shapes, rng.normal(size=(24, 3)).astype(np.float32)), 150, 70, (0, 0), isa)


@settings(max_examples=examples(40))
@given(
    st.integers(1, 60),
    st.integers(1, 60),
    st.tuples(st.integers(-100, 100), st.integers(-100, 100)),
    st.integers(0, 12),
    st.sampled_from([1, 2, 3, 4, 6]),
    st.sampled_from(ISAS),
    st.integers(0, 2**32 - 1),
)
def test_any_crop(
    width: int, height: int, origin: tuple[int, int], count: int, channels: int, isa: str, seed: int
) -> None:
    means, covariances, colours = random_scene(np.random.default_rng(seed), count, channels, width, height, ratio=10.0)
    check((means + np.float32(origin), covariances, colours), width, height, origin, isa, seed)


@every_isa
def test_nothing_to_draw(isa: str) -> None:
    empty = random_scene(np.random.default_rng(0), 0, 3, 1, 1)
    far = (np.full((1, 2), 1000, np.float32), np.array([[1, 0, 1]], np.float32), np.ones((1, 3), np.float32))
    for scene in (empty, far):
        raster = NativeRasterizer(Device(1, isa))
        assert not raster.forward(*scene, 20, 10).any()
        assert raster.tile_pairs == 0
        gradients = backward(raster, scene, np.ones((3, 10, 20), np.float32))
        assert [g.shape for g in gradients] == [array.shape for array in scene]
        assert not any(g.any() for g in gradients)
        assert raster.error(*scene, np.ones((3, 10, 20), np.float32), weight=0.5)[0].loss == 300.0


@every_isa
@pytest.mark.parametrize("cutoff", [2.0, 3.5])
def test_a_cutoff_leaves_out_no_more_than_the_tails(isa: str, cutoff: float) -> None:
    scene = random_scene(np.random.default_rng(5), 40, 3, 64, 48, sigma=(0.5, 8.0), ratio=6.0, margin=10.0)
    image = NativeRasterizer(Device(1, isa), cutoff).forward(*scene, 64, 48)
    values = values_of(scene, 64, 48)
    tails = np.where(values < np.exp(-0.5 * cutoff**2) * (1 + 1e-4), values, 0)
    bound = np.tensordot(np.abs(scene[2]).T, tails, axes=1)
    error = np.abs(image - rasterize_reference(*exact(scene), 64, 48))
    assert np.all(error <= bound + FORWARD * (magnitude(scene, 64, 48) + 0.02))
    assert error.max() > 0.01 * bound.max()  # it does cut


@every_isa
def test_a_smaller_cutoff_visits_fewer_tiles(isa: str) -> None:
    scene = random_scene(np.random.default_rng(5), 40, 1, 200, 200, sigma=(5.0, 9.0))
    pairs = []
    for cutoff in (2.0, 3.5, 6.0):
        raster = NativeRasterizer(Device(1, isa), cutoff)
        raster.forward(*scene, 200, 200)
        pairs.append(raster.tile_pairs)
    assert pairs[0] < pairs[1] < pairs[2]


@every_isa
@pytest.mark.parametrize("channels", [1, 3, 6])
@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("loss", ["squared", "absolute"])
def test_error_is_that_of_the_reference(loss: Loss, weighted: bool, channels: int, isa: str) -> None:
    """A wide cutoff, so that what is left out is below rounding."""
    rng = np.random.default_rng(channels)
    scene = random_scene(rng, 60, channels, 70, 45, sigma=(0.5, 6.0), ratio=4.0)
    target = rng.normal(size=(channels, 45, 70)).astype(np.float32)
    weights = rng.uniform(0.1, 3.0, (45, 70)).astype(np.float32) if weighted else None
    for origin in ((0, 0), (-7, 21)):
        raster = NativeRasterizer(Device(2, isa), 7.0)
        found, gradients = raster.error(*scene, target, loss, 0.3, weights, origin)
        wide = None if weights is None else weights.astype(np.float64)
        expected, exact_gradients = ReferenceRasterizer().error(
            *exact(scene), target.astype(np.float64), loss, 0.3, wide, origin
        )
        assert found == pytest.approx(expected, rel=1e-6)
        for one, two in zip(gradients, exact_gradients, strict=True):
            np.testing.assert_allclose(one, two, atol=2e-4 * np.abs(two).max())


@every_isa
def test_absolute_error_has_no_slope_where_nothing_differs(isa: str) -> None:
    """Pixels that agree count nothing, in whole vectors and beside them."""
    means, covariances, _ = random_scene(np.random.default_rng(4), 60, 3, 70, 45, sigma=(0.5, 6.0))
    nothing = np.zeros((3, 45, 70), np.float32)
    raster = NativeRasterizer(Device(2, isa))
    found, gradients = raster.error(means, covariances, np.zeros((60, 3), np.float32), nothing, "absolute")
    assert found == (0.0, 0.0)
    assert not any(gradient.any() for gradient in gradients)


@every_isa
def test_weights_of_one_are_plain_squared_error(isa: str) -> None:
    rng = np.random.default_rng(2)
    scene = random_scene(rng, 60, 3, 70, 45, sigma=(0.5, 6.0), ratio=4.0)
    target, ones = rng.normal(size=(3, 45, 70)).astype(np.float32), np.ones((45, 70), np.float32)
    raster = NativeRasterizer(Device(2, isa))
    (weighted, plain), gradients = raster.error(*scene, target, weights=ones)
    (loss, _), expected = raster.error(*scene, target)
    assert (weighted, plain) == pytest.approx((loss, loss), rel=1e-6)
    for one, two in zip(gradients, expected, strict=True):
        np.testing.assert_array_equal(one, two)


WHOLE = 120
WHOLE_ORIGIN = (-40, -35)
CROP_SCENE = random_scene(np.random.default_rng(11), 150, 3, 80, 80, sigma=(0.3, 12.0), ratio=8.0)


@pytest.fixture(scope="module")
def whole() -> dict[str, np.ndarray]:
    return {isa: NativeRasterizer(Device(1, isa)).forward(*CROP_SCENE, WHOLE, WHOLE, WHOLE_ORIGIN) for isa in ISAS}


@given(st.data())
def test_a_crop_of_the_picture_is_the_picture_of_the_crop(whole: dict[str, np.ndarray], data: st.DataObject) -> None:
    isa = data.draw(st.sampled_from(ISAS))
    left, top = data.draw(st.integers(0, WHOLE - 1)), data.draw(st.integers(0, WHOLE - 1))
    width, height = data.draw(st.integers(1, WHOLE - left)), data.draw(st.integers(1, WHOLE - top))
    origin = (WHOLE_ORIGIN[0] + left, WHOLE_ORIGIN[1] + top)
    crop = NativeRasterizer(Device(1, isa)).forward(*CROP_SCENE, width, height, origin)
    np.testing.assert_array_equal(crop, whole[isa][:, top : top + height, left : left + width])


@every_isa
def test_the_number_of_threads_changes_no_byte(isa: str) -> None:
    rng = np.random.default_rng(3)
    scene = random_scene(rng, 10_000, 3, 230, 170, sigma=(0.4, 2.0), ratio=3.0, margin=5.0)
    target = rng.normal(size=(3, 170, 230)).astype(np.float32)
    results = []
    for threads in (1, 2, 3, 0):
        raster = NativeRasterizer(Device(threads, isa))
        image = raster.forward(*scene, 230, 170)
        (loss, _), gradients = raster.error(*scene, target)
        results.append((loss, [array.tobytes() for array in (image, *gradients)]))
    assert all(result == results[0] for result in results)


def test_an_instance_may_change_its_size() -> None:
    raster = NativeRasterizer(Device(1))
    rng = np.random.default_rng(4)
    for count, side in ((50, 64), (3, 17), (200, 90), (0, 5)):
        scene = random_scene(rng, count, 3, side, side, sigma=(1.0, 4.0))
        image = raster.forward(*scene, side, side)
        np.testing.assert_array_equal(image, NativeRasterizer(Device(1)).forward(*scene, side, side))


@every_isa
def test_memory_is_bounded(isa: str) -> None:
    """Ten Gaussians, the last of which touch all of 4×3 tiles."""
    means = np.full((10, 2), 8, np.float32)
    covariances = np.array([[1, 0, 1]] * 7 + [[1e6, 0, 1e6]] * 3, np.float32)
    scene = (means, covariances, np.ones((10, 1), np.float32))
    raster = NativeRasterizer(Device(2, isa), most_pairs=7 + 36)
    raster.forward(*scene, 256, 96)
    assert raster.tile_pairs == 7 + 36
    with pytest.raises(OverflowError, match="smaller crops"):
        NativeRasterizer(Device(2, isa), most_pairs=7 + 35).forward(*scene, 256, 96)
    with pytest.raises(OverflowError, match="smaller crops"):
        raster.forward(*scene, 320, 96)


def test_wrong_arguments_are_refused() -> None:
    means, covariances, colours = random_scene(np.random.default_rng(0), 4, 3, 8, 8)
    raster = NativeRasterizer()
    with pytest.raises(ValueError, match="covariances"):
        raster.forward(means, covariances[:3].copy(), colours, 8, 8)
    with pytest.raises(ValueError, match="instruction set"):
        NativeRasterizer(Device(isa="mmx"))
    with pytest.raises(ValueError, match="smaller"):
        raster.forward(means, covariances, colours, 8, 8, (2**31 - 4, 0))
