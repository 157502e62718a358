"""Scaled Gaussians against pictures that were scaled after drawing."""

import numpy as np
import pytest
from scenes import exact, random_scene

from sgicodec.device import Device
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.reference import rasterize_reference
from sgicodec.raster.rescaling import scaled

SIDE = 192


def draw(scene: tuple[np.ndarray, ...], side: int) -> np.ndarray:
    return NativeRasterizer(Device(2), cutoff=6.0).forward(*scene, side, side)


def shrunk(image: np.ndarray, factor: int) -> np.ndarray:
    channels, side, _ = image.shape
    return image.reshape(channels, side // factor, factor, side // factor, factor).mean(axis=(2, 4))


def psnr(a: np.ndarray, b: np.ndarray) -> float:
    """Decibels against an amplitude of 1."""
    return float(-10 * np.log10(np.mean((a - b) ** 2)))


@pytest.mark.parametrize("factor", [2, 4, 8])
@pytest.mark.parametrize("sigma", [(0.25, 1.0), (0.5, 8.0), (2.0, 8.0)])
def test_shrinking_is_an_area_mean(factor: int, sigma: tuple[float, float]) -> None:
    means, covariances, colours = random_scene(
        np.random.default_rng(1), 2500, 3, SIDE, SIDE, sigma=sigma, ratio=2.0, margin=10.0
    )
    covariances += np.float32([0.05, 0, 0.05])  # as model.gaussians gives them
    colours *= np.float32(0.3 / max(1.0, sigma[1] / 2))
    expected = shrunk(draw((means, covariances, colours), SIDE), factor)
    image = draw(scaled(means, covariances, colours, (1 / factor, 1 / factor)), SIDE // factor)
    assert psnr(image, expected) > 40
    unfiltered = draw((means / factor, covariances / factor**2, colours), SIDE // factor)
    assert psnr(image, expected) > psnr(unfiltered, expected) + 8


def test_enlarging_draws_between_the_pixels() -> None:
    scene = random_scene(np.random.default_rng(2), 30, 2, 20, 20, sigma=(0.5, 4.0), ratio=3.0)
    means, covariances, colours = exact(scene)
    larger = scaled(means, covariances, colours, (3.0, 3.0))
    np.testing.assert_array_equal(larger[2], colours)
    image = rasterize_reference(*larger, 60, 60)
    # Of three pixels the middle one has its centre where the old pixel had it.
    np.testing.assert_allclose(
        image[:, 1::3, 1::3], rasterize_reference(means, covariances, colours, 20, 20), atol=1e-12
    )


@pytest.mark.parametrize("scale", [(0.5, 0.25), (0.3, 2.0), (1.0, 1.0), (1.7, 0.9)])
def test_axes_are_independent_and_integrals_kept(scale: tuple[float, float]) -> None:
    means, covariances, colours = exact(random_scene(np.random.default_rng(3), 20, 1, 9, 9, ratio=5.0))
    start = (3.0, -2.0)
    new_means, new_covariances, new_colours = scaled(means, covariances, colours, scale, start)
    np.testing.assert_allclose(new_means, (means - start) * scale)
    volume = [
        colour[:, 0] * np.sqrt(np.linalg.det(shape[:, [0, 1, 1, 2]].reshape(-1, 2, 2)))
        for colour, shape in ((colours, covariances), (new_colours, new_covariances))
    ]
    np.testing.assert_allclose(volume[1], volume[0] * scale[0] * scale[1], rtol=1e-9)
    added = new_covariances - covariances * [scale[0] ** 2, scale[0] * scale[1], scale[1] ** 2]
    assert np.all((added[:, [0, 2]] > 1e-3) == (np.array(scale) < 1))
    np.testing.assert_allclose(added[:, 1], 0, atol=1e-12)


def test_precision_and_hostile_numbers_pass_through() -> None:
    bad = np.array([[np.nan, 0, 1], [np.inf, 0, 1], [1, 5, 1], [0, 0, 0], [3e38, 0, 3e38]], np.float32)
    means, colours = np.ones((5, 2), np.float32), np.ones((5, 1), np.float32)
    with np.errstate(all="raise"):
        view = scaled(means, bad, colours, (0.5, 0.5))
    assert [array.dtype for array in view] == [np.float32] * 3
    image = NativeRasterizer(Device(1)).forward(*view, 8, 8)
    assert np.isfinite(image).all()


def test_what_has_no_area_keeps_a_finite_colour() -> None:
    """Rounding may make such a covariance drawable once it is scaled: 0 / 0 must not become its colour."""
    means = np.zeros((3, 2), np.float32)
    covariances = np.array([[1e10, -1e10, 1e10], [1e22, 1e22, 1e22], [1.0, np.nan, 1.0]], np.float32)
    for scale in ((1.42, 6.49), (2.0, 0.5), (1.0, 4.0)):
        assert np.isfinite(scaled(means, covariances, np.ones((3, 1), np.float32), scale)[2]).all()
