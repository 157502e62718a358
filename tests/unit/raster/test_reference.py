"""The yardstick itself: against the formula in plain Python, and its gradients against finite differences."""

import numpy as np
import pytest
from reference_raster import ReferenceRasterizer, rasterize_reference, rasterize_reference_backward
from scenes import exact, random_scene

from sgicodec.raster.backend import Loss

ORIGIN = (-3, 5)


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("loss", ["squared", "absolute"])
def test_error_against_central_differences(loss: Loss, weighted: bool) -> None:
    rng = np.random.default_rng(7)
    arrays = exact(random_scene(rng, 3, 2, 8, 6, sigma=(1.0, 3.0), ratio=3.0, margin=0.0))
    target, weights = rng.normal(size=(2, 6, 8)), rng.uniform(0.1, 2.0, (6, 8)) if weighted else None
    raster = ReferenceRasterizer()
    errors, gradients = raster.error(*arrays, target, loss, 0.25, weights, (1, -1))
    error = raster.forward(*arrays, 8, 6, (1, -1)) - target
    size = 0.25 * (error**2 if loss == "squared" else np.abs(error)) * (1 if weights is None else weights)
    assert errors == pytest.approx((float(size.sum()), float(np.sum(error**2))))
    direction = [rng.normal(size=array.shape) for array in arrays]
    ahead, behind = (
        raster.error(
            *(a + sign * 1e-6 * d for a, d in zip(arrays, direction, strict=True)), target, loss, 0.25, weights, (1, -1)
        )
        for sign in (1, -1)
    )
    slope = sum(float(np.sum(g * d)) for g, d in zip(gradients, direction, strict=True))
    assert (ahead[0].loss - behind[0].loss) / 2e-6 == pytest.approx(slope, rel=1e-5)


def test_what_is_no_gaussian_is_left_out() -> None:
    means = np.array([[2.0, 2.0], [np.nan, 2.0], [2.0, 2.0], [2.0, 2.0]])
    covariances = np.array([[1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 2.0, 1.0], [np.inf, 0.0, 1.0]])
    colours = np.ones((4, 1))
    image = rasterize_reference(means, covariances, colours, 4, 4)
    np.testing.assert_array_equal(image, rasterize_reference(means[:1], covariances[:1], colours[:1], 4, 4))
    gradients = rasterize_reference_backward(means, covariances, colours, np.ones((1, 4, 4)))
    assert all(not gradient[1:].any() and gradient[:1].any() for gradient in gradients[1:])
