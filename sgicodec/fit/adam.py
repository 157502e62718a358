"""Adam (Kingma and Ba 2015) over named groups of tensors whose rows come and go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import torch
from torch import Tensor
from torch.optim.adam import adam

__all__ = ["Adam", "Group"]


@dataclass
class Group:
    """Tensors that share a learning rate `base`; `factor` scales it from step to step."""

    name: str
    tensors: list[Tensor]
    base: float
    factor: float = 1.0
    means: list[Tensor] = field(default_factory=list)
    squares: list[Tensor] = field(default_factory=list)
    counts: list[Tensor] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.means = [torch.zeros_like(tensor) for tensor in self.tensors]
        self.squares = [torch.zeros_like(tensor) for tensor in self.tensors]
        self.counts = [torch.zeros(()) for _ in self.tensors]


class Adam:
    """The arithmetic is torch's fused kernel. The class is ours because torch's own imports its compiler, which takes a
    second, and because tensors here change their number of rows and keep their moments.
    """

    def __init__(self, groups: list[Group], betas: tuple[float, float], epsilon: float) -> None:
        self.groups, self.betas, self.epsilon = groups, betas, epsilon

    def clear(self) -> None:
        """Forgets all gradients."""
        for group in self.groups:
            for tensor in group.tensors:
                tensor.grad = None

    @torch.no_grad()
    def step(self) -> None:
        """Moves every tensor that has a gradient."""
        for group in self.groups:
            live = [i for i, tensor in enumerate(group.tensors) if tensor.grad is not None]
            if not live:
                continue
            adam(
                [group.tensors[i] for i in live],
                [gradient for i in live if (gradient := group.tensors[i].grad) is not None],
                [group.means[i] for i in live],
                [group.squares[i] for i in live],
                [],
                [group.counts[i] for i in live],
                foreach=False,
                capturable=False,
                differentiable=False,
                fused=True,
                has_complex=False,
                amsgrad=False,
                beta1=self.betas[0],
                beta2=self.betas[1],
                lr=group.base * group.factor,
                weight_decay=0.0,
                eps=self.epsilon,
                maximize=False,
            )

    def replace(self, name: str, change: Callable[[Tensor], Tensor]) -> Tensor:
        """Puts `change(tensor)` in the place of the one tensor of a group, and the same of its moments."""
        group = next(group for group in self.groups if group.name == name)
        new = change(group.tensors[0].detach()).clone().requires_grad_()
        group.tensors[0] = new
        group.means[0], group.squares[0] = change(group.means[0]), change(group.squares[0])
        return new
