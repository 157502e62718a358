"""The native back end on every instruction set: cutoffs, crops, threads and bounds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference_raster import rasterize_reference
from scenes import ISAS, exact, magnitude, random_scene, values_of

from sgicodec.device import Device
from sgicodec.raster.cpu import NativeRasterizer

FORWARD = 4e-5  # rounding, relative to the sum of magnitudes

every_isa = pytest.mark.parametrize("isa", ISAS)


def test_at_least_one_instruction_set_is_tested() -> None:
    assert "portable" in ISAS
    assert NativeRasterizer().isa == ISAS[0]  # auto takes the widest


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
