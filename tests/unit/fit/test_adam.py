"""Adam against torch's own, with rates that change, gradients that are missing, and rows that come and go."""

from __future__ import annotations

import pytest
import torch
from torch import Tensor

from sgicodec.fit.adam import Adam, Group

BETAS, EPSILON = (0.9, 0.99), 1e-12


class Pair:
    """The same two groups under both optimisers, in float64."""

    def __init__(self) -> None:
        generator = torch.Generator().manual_seed(1)
        first = [torch.randn(5, 3, generator=generator, dtype=torch.float64)]
        second = [torch.randn(4, generator=generator, dtype=torch.float64) for _ in range(2)]
        self.generator = generator
        self.ours = Adam(
            [
                Group("first", [t.clone().requires_grad_() for t in first], 0.1),
                Group("second", [t.clone().requires_grad_() for t in second], 0.02),
            ],
            BETAS,
            EPSILON,
        )
        self.theirs = [
            [t.clone().requires_grad_() for t in first],
            [t.clone().requires_grad_() for t in second],
        ]
        self.reference = torch.optim.Adam(
            [{"params": tensors, "lr": rate} for tensors, rate in zip(self.theirs, (0.1, 0.02), strict=True)],
            betas=BETAS,
            eps=EPSILON,
        )

    def step(self, factors: tuple[float, float] = (1.0, 1.0), without: tuple[int, int] | None = None) -> None:
        """One step of both with equal random gradients; the tensor `without` (group, index) has none."""
        self.ours.clear()
        self.reference.zero_grad(set_to_none=True)
        for number, (group, tensors) in enumerate(zip(self.ours.groups, self.theirs, strict=True)):
            group.factor = factors[number]
            self.reference.param_groups[number]["lr"] = group.base * factors[number]
            for index, (mine, other) in enumerate(zip(group.tensors, tensors, strict=True)):
                if (number, index) != without:
                    gradient = torch.randn(other.shape, generator=self.generator, dtype=torch.float64)
                    mine.grad, other.grad = gradient.clone(), gradient.clone()
        self.ours.step()
        self.reference.step()

    def check(self) -> None:
        for group, tensors in zip(self.ours.groups, self.theirs, strict=True):
            for mine, other in zip(group.tensors, tensors, strict=True):
                torch.testing.assert_close(mine, other, rtol=1e-12, atol=1e-14)


def test_equals_torch_with_rates_that_change() -> None:
    pair = Pair()
    for number in range(20):
        pair.step((1.0 - 0.03 * number, 0.5 if number % 3 else 0.0))
        pair.check()


def test_a_tensor_without_gradient_stays() -> None:
    pair = Pair()
    pair.step()
    before = pair.ours.groups[1].tensors[1].detach().clone()
    pair.step(without=(1, 1))
    assert torch.equal(pair.ours.groups[1].tensors[1], before)
    pair.step()
    pair.check()


def test_no_gradients_at_all_change_nothing() -> None:
    pair = Pair()
    pair.ours.clear()
    before = [t.detach().clone() for group in pair.ours.groups for t in group.tensors]
    pair.ours.step()
    after = [t for group in pair.ours.groups for t in group.tensors]
    assert all(torch.equal(a, b) for a, b in zip(after, before, strict=True))


@pytest.mark.parametrize(
    "change",
    [
        lambda t: t[torch.tensor([True, False, True, True, False])],
        lambda t: t[torch.tensor([4, 0, 2])],
        lambda t: torch.cat([t, torch.zeros(2, 3, dtype=t.dtype)]),
    ],
    ids=["drop", "reorder", "add"],
)
def test_rows_keep_their_moments(change: object) -> None:
    """Torch's optimiser gets the changed tensor, and the changed moments put into its state by hand."""
    assert callable(change)
    pair = Pair()
    for _ in range(3):
        pair.step()
    new = pair.ours.replace("first", change)
    assert new is pair.ours.groups[0].tensors[0]
    assert new.requires_grad
    assert new.is_leaf
    old = pair.theirs[0][0]
    state = pair.reference.state.pop(old)
    other: Tensor = change(old.detach()).clone().requires_grad_()
    moments = {name: change(state[name]).clone() for name in ("exp_avg", "exp_avg_sq")}
    pair.reference.state[other] = {"step": state["step"], **moments}
    pair.reference.param_groups[0]["params"] = [other]
    pair.theirs[0] = [other]
    for _ in range(5):
        pair.step()
        pair.check()


def test_replaced_rows_are_copies() -> None:
    pair = Pair()
    before = pair.ours.groups[0].tensors[0].detach()
    new = pair.ours.replace("first", lambda t: t)
    with torch.no_grad():
        new += 1.0
    assert not torch.equal(new.detach(), before)
