"""Adam (Kingma and Ba 2015) on named arrays whose rows come and go."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.arrays import F32
from sgicodec.device import ONE_THREAD, Device


@dataclass
class _Moments:
    """mean, square: running averages of the gradient and of its square, shaped as the array; count: steps so far."""

    mean: F32
    square: F32
    count: int = 0


class Adam:
    """Moves arrays in place and keeps the moments of each under its name. Same result for any number of threads."""

    def __init__(self, betas: tuple[float, float], epsilon: float, device: Device = ONE_THREAD) -> None:
        self.betas, self.epsilon, self.device = betas, epsilon, device
        self._moments: dict[str, _Moments] = {}

    def move(self, name: str, values: F32, gradient: F32, rate: float) -> None:
        """One step of the array `values` down its gradient, at this learning rate."""
        if name not in self._moments:
            self._moments[name] = _Moments(np.zeros_like(values), np.zeros_like(values))
        moments, (beta1, beta2) = self._moments[name], self.betas
        moments.count += 1
        _native.adam_step(
            values.reshape(-1),
            gradient.reshape(-1),
            moments.mean.reshape(-1),
            moments.square.reshape(-1),
            beta1,
            beta2,
            rate / (1.0 - beta1**moments.count),
            (1.0 - beta2**moments.count) ** 0.5,
            self.epsilon,
            self.device.threads,
            self.device.isa,
        )

    def keep(self, name: str, rows: NDArray[Any]) -> None:
        """Drops the moments of all rows but these (a mask or indices)."""
        if (moments := self._moments.get(name)) is not None:
            moments.mean, moments.square = moments.mean[rows], moments.square[rows]

    def add(self, name: str, count: int) -> None:
        """Appends the moments of new rows: zeros."""
        if (moments := self._moments.get(name)) is not None:
            fresh = np.zeros((count, *moments.mean.shape[1:]), np.float32)
            moments.mean, moments.square = (np.concatenate([m, fresh]) for m in (moments.mean, moments.square))
