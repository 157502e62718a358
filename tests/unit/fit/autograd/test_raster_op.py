"""The torch operations against the dense sum and its gradients."""

import numpy as np
import pytest
import torch

from sgicodec.device import Device
from sgicodec.fit.autograd.raster_op import absolute_error, rasterize, squared_error
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.reference import rasterize_reference, rasterize_reference_backward

WIDTH, HEIGHT = 40, 25


def gaussians(channels: int) -> list[torch.Tensor]:
    rng = np.random.default_rng(channels)
    means = rng.uniform([0, 0], [WIDTH, HEIGHT], (30, 2))
    covariances = np.stack([rng.uniform(2, 9, 30), rng.uniform(-1, 1, 30), rng.uniform(2, 9, 30)], axis=1)
    colours = rng.normal(size=(30, channels))
    return [torch.tensor(a, dtype=torch.float32, requires_grad=True) for a in (means, covariances, colours)]


def exact(tensors: list[torch.Tensor]) -> list[np.ndarray]:
    return [tensor.detach().numpy().astype(np.float64) for tensor in tensors]


@pytest.mark.parametrize("channels", [1, 3, 5])
def test_rasterize(channels: int) -> None:
    tensors = gaussians(channels)
    weights = torch.randn(channels, HEIGHT, WIDTH, generator=torch.Generator().manual_seed(0))
    image = rasterize(*tensors, (WIDTH, HEIGHT), NativeRasterizer(Device(1), cutoff=6.0))
    expected = rasterize_reference(*exact(tensors), WIDTH, HEIGHT)
    np.testing.assert_allclose(image.detach().numpy(), expected, atol=1e-4)
    (weights * image).sum().backward()
    gradients = rasterize_reference_backward(*exact(tensors), weights.numpy().astype(np.float64))
    for tensor, gradient in zip(tensors, gradients, strict=True):
        np.testing.assert_allclose(tensor.grad.numpy(), gradient, rtol=1e-3, atol=1e-3)


def test_gradients_flow_from_views_and_expanded_gradients() -> None:
    """What autograd hands over need not be contiguous."""
    means, covariances, colours = gaussians(3)
    wide = torch.cat([means, means], dim=1).detach().requires_grad_()
    image = rasterize(wide[:, :2], covariances, colours, (WIDTH, HEIGHT), NativeRasterizer(Device(1)))
    image.sum().backward()  # an expanded scalar
    expected = gaussians(3)
    rasterize(*expected, (WIDTH, HEIGHT), NativeRasterizer(Device(1))).backward(torch.ones(3, HEIGHT, WIDTH))
    np.testing.assert_array_equal(wide.grad[:, :2].numpy(), expected[0].grad.numpy())
    assert not wide.grad[:, 2:].any()


@pytest.mark.parametrize("channels", [1, 3])
def test_squared_error_is_that_of_the_image(channels: int) -> None:
    target = torch.rand(channels, HEIGHT, WIDTH, generator=torch.Generator().manual_seed(1))
    fused, composed = gaussians(channels), gaussians(channels)
    raster = NativeRasterizer(Device(1))
    loss = squared_error(*fused, target, raster)
    image = rasterize(*composed, (WIDTH, HEIGHT), raster)
    expected = ((image - target) ** 2).sum()
    assert float(loss.detach()) == pytest.approx(float(expected.detach()), rel=1e-5)
    (3.0 * loss).backward()
    (3.0 * expected).backward()
    for one, two in zip(fused, composed, strict=True):
        np.testing.assert_allclose(one.grad.numpy(), two.grad.numpy(), rtol=1e-4, atol=1e-4)


def test_absolute_error_is_the_mean_over_the_image() -> None:
    target = torch.rand(3, HEIGHT, WIDTH, generator=torch.Generator().manual_seed(1))
    fused, composed = gaussians(3), gaussians(3)
    raster = NativeRasterizer(Device(1))
    loss, squared = absolute_error(*fused, target, raster)
    image = rasterize(*composed, (WIDTH, HEIGHT), raster)
    expected = (image - target).abs().mean()
    assert float(loss.detach()) == pytest.approx(float(expected.detach()), rel=1e-5)
    assert squared == pytest.approx(float(((image.detach() - target) ** 2).sum()), rel=1e-5)
    (3.0 * loss).backward()
    (3.0 * expected).backward()
    for one, two in zip(fused, composed, strict=True):
        np.testing.assert_allclose(one.grad.numpy(), two.grad.numpy(), rtol=1e-4, atol=1e-7)


def test_a_stale_forward_pass_is_refused() -> None:
    raster = NativeRasterizer(Device(1))
    image = rasterize(*gaussians(1), (WIDTH, HEIGHT), raster)
    rasterize(*gaussians(1), (WIDTH, HEIGHT + 1), raster)
    with pytest.raises(ValueError, match="forward"):
        image.sum().backward()
