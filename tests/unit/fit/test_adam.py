"""Adam against torch's own, with rates that change, gradients that are missing, and rows that come and go."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.fit.adam import Adam

BETAS, EPSILON = (0.9, 0.99), 1e-12


class Pair:
    """The same two arrays under both optimisers: ours in float32, torch's in float64."""

    def __init__(self, device: Device | None = None) -> None:
        self.rng = np.random.default_rng(1)
        self.values = {
            "first": self.rng.normal(size=(5, 3)).astype(np.float32),
            "second": self.rng.normal(size=4).astype(np.float32),
        }
        self.ours = Adam(BETAS, EPSILON, device or Device(threads=1))
        self.theirs = {name: torch.from_numpy(value.astype(np.float64)) for name, value in self.values.items()}
        self.reference = torch.optim.Adam(
            [{"params": [tensor.requires_grad_()], "lr": 0.0} for tensor in self.theirs.values()],
            betas=BETAS,
            eps=EPSILON,
        )

    def step(self, rates: tuple[float, float] = (0.1, 0.02), without: str = "") -> None:
        """One step of both with equal random gradients; the array `without` has none."""
        self.reference.zero_grad(set_to_none=True)
        for (name, value), rate, group in zip(self.values.items(), rates, self.reference.param_groups, strict=True):
            group["lr"] = rate
            if name != without:
                gradient = (self.rng.normal(size=value.shape) * 10.0 ** self.rng.integers(-6, 3)).astype(np.float32)
                self.theirs[name].grad = torch.from_numpy(gradient.astype(np.float64))
                self.ours.move(name, value, gradient, rate)
        self.reference.step()

    def check(self) -> None:
        for name, value in self.values.items():
            np.testing.assert_allclose(value, self.theirs[name].detach().numpy(), rtol=1e-5, atol=2e-6)


@pytest.mark.parametrize("isa", ["auto", "portable"])
def test_equals_torch_with_rates_that_change(isa: str) -> None:
    pair = Pair(Device(1, isa))
    for number in range(20):
        pair.step((0.1 * (1.0 - 0.03 * number), 0.01 if number % 3 else 0.0))
        pair.check()


@pytest.mark.parametrize(
    "rows", [np.array([True, False, True, True, False]), np.array([4, 0, 2])], ids=["drop", "reorder"]
)
def test_rows_keep_their_moments(rows: NDArray[Any]) -> None:
    pair = changed(lambda value: value[rows], lambda adam: adam.keep("first", rows))
    assert len(pair.values["first"]) == 3


def changed(change: Any, tell: Any) -> Pair:
    """Both after a change of rows and five more steps, compared after each.

    Torch's optimiser gets the changed tensor, and the changed moments put into its state by hand.
    """
    pair = Pair()
    for _ in range(3):
        pair.step()
    pair.values["first"] = change(pair.values["first"])
    tell(pair.ours)
    old = pair.theirs["first"]
    state = pair.reference.state.pop(old)
    new = torch.from_numpy(change(old.detach().numpy())).requires_grad_()
    moments = {name: torch.from_numpy(change(state[name].numpy())) for name in ("exp_avg", "exp_avg_sq")}
    pair.reference.state[new] = {"step": state["step"], **moments}
    pair.reference.param_groups[0]["params"] = [new]
    pair.theirs["first"] = new
    for _ in range(5):
        pair.step()
        pair.check()
    return pair


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
