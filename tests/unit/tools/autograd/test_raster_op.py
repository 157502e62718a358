"""The torch operation against the back end that it wraps."""

import numpy as np
import pytest
import torch

from sgicodec.device import Device
from sgicodec.raster.backend import Loss
from sgicodec.raster.cpu import NativeRasterizer
from tools.autograd.raster_op import error

WIDTH, HEIGHT = 40, 25
RASTER = NativeRasterizer(Device(1))


def gaussians(channels: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    rng = np.random.default_rng(channels)
    means = rng.uniform([0, 0], [WIDTH, HEIGHT], (30, 2))
    covariances = np.stack([rng.uniform(2, 9, 30), rng.uniform(-1, 1, 30), rng.uniform(2, 9, 30)], axis=1)
    first, second, third = (
        torch.tensor(a, dtype=torch.float32, requires_grad=True)
        for a in (means, covariances, rng.normal(size=(30, channels)))
    )
    return first, second, third


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("loss", ["squared", "absolute"])
def test_error_is_the_back_ends(loss: Loss, weighted: bool) -> None:
    rng = np.random.default_rng(1)
    target = rng.random((3, HEIGHT, WIDTH), np.float32)
    weights = rng.random((HEIGHT, WIDTH), np.float32) if weighted else None
    tensors = gaussians(3)
    found, squared = error(tensors, torch.from_numpy(target), RASTER, loss, 0.3, weights)
    arrays = [tensor.detach().numpy() for tensor in tensors]
    expected, gradients = RASTER.error(*arrays, target, loss, 0.3, weights)
    assert float(found.detach()) == pytest.approx(expected.loss, rel=1e-6)
    assert squared == expected.squared
    (3.0 * found).backward()  # type: ignore[no-untyped-call]
    for tensor, gradient in zip(tensors, gradients, strict=True):
        np.testing.assert_allclose(tensor.grad.numpy(), 3 * gradient, rtol=1e-6)


def test_gradients_flow_to_views() -> None:
    """What autograd hands over need not be contiguous."""
    target = torch.zeros(3, HEIGHT, WIDTH)
    means, covariances, colours = gaussians(3)
    wide = torch.cat([means, means], dim=1).detach().requires_grad_()
    error((wide[:, :2], covariances, colours), target, RASTER)[0].backward()  # type: ignore[no-untyped-call]
    expected = gaussians(3)
    error(expected, target, RASTER)[0].backward()  # type: ignore[no-untyped-call]
    np.testing.assert_array_equal(wide.grad[:, :2].numpy(), expected[0].grad.numpy())
    assert not wide.grad[:, 2:].any()
