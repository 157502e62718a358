"""Adam against torch's own, with rates that change."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from sgicodec.device import Device
from sgicodec.fit.adam import Adam

BETAS, EPSILON = (0.9, 0.99), 1e-12


@pytest.mark.parametrize("isa", ["auto", "portable"])
def test_equals_torch_with_rates_that_change(isa: str) -> None:
    """Two arrays at rates of their own, ours in float32, torch's in float64, under gradients of any size."""
    rng = np.random.default_rng(1)
    values = {"first": rng.normal(size=(5, 3)).astype(np.float32), "second": rng.normal(size=4).astype(np.float32)}
    theirs = {name: torch.from_numpy(value.astype(np.float64)).requires_grad_() for name, value in values.items()}
    groups = [{"params": [tensor], "lr": 0.0} for tensor in theirs.values()]
    ours, reference = Adam(BETAS, EPSILON, Device(1, isa)), torch.optim.Adam(groups, betas=BETAS, eps=EPSILON)
    for number in range(20):
        rates = (0.1 * (1.0 - 0.03 * number), 0.01 if number % 3 else 0.0)
        for (name, value), rate, group in zip(values.items(), rates, reference.param_groups, strict=True):
            gradient = (rng.normal(size=value.shape) * 10.0 ** rng.integers(-6, 3)).astype(np.float32)
            group["lr"], theirs[name].grad = rate, torch.from_numpy(gradient.astype(np.float64))
            ours.move(name, value, gradient, rate)
        reference.step()
        for name, value in values.items():
            np.testing.assert_allclose(value, theirs[name].detach().numpy(), rtol=1e-5, atol=2e-6)


def test_threads_change_no_bit() -> None:
    rng = np.random.default_rng(2)
    start, gradients = rng.normal(size=100_003), rng.normal(size=(3, 100_003)).astype(np.float32)
    found = []
    for threads in (1, 2, 5):
        values, adam = start.astype(np.float32), Adam(BETAS, EPSILON, Device(threads))
        for gradient in gradients:
            adam.move("all", values, gradient, 0.1)
        found.append(values)
    np.testing.assert_array_equal(found[1], found[0])
    np.testing.assert_array_equal(found[2], found[0])
