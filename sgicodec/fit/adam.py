"""Adam (Kingma and Ba 2015) on named arrays whose rows come and go."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.device import ONE_THREAD, Device

__all__ = ["Adam", "Moments"]

F32 = NDArray[np.float32]


@dataclass
class Moments:
    """mean, square: running averages of the gradient and of its square, shaped as the array; count: steps so far."""

    mean: F32
    square: F32
    count: int = 0


class Adam:
    """Moves arrays in place and keeps the moments of each under its name. Same result for any number of threads."""

    def __init__(self, betas: tuple[float, float], epsilon: float, device: Device = ONE_THREAD) -> None:
        self.betas, self.epsilon, self.device = betas, epsilon, device
        self._moments: dict[str, Moments] = {}

    def move(self, name: str, values: F32, gradient: F32, rate: float) -> None:
        """One step of the array `values` down its gradient, at this learning rate."""
        moments, (beta1, beta2) = self.moments(name, values), self.betas
        corrected, root = self.corrections(name, rate)
        _native.adam_step(
            values.reshape(-1),
            gradient.reshape(-1),
            moments.mean.reshape(-1),
            moments.square.reshape(-1),
            beta1,
            beta2,
            corrected,
            root,
            self.epsilon,
            self.device.threads,
            self.device.isa,
        )

    def moments(self, name: str, values: F32) -> Moments:
        """Those of an array, zero before its first step."""
        if name not in self._moments:
            self._moments[name] = Moments(np.zeros_like(values), np.zeros_like(values))
        return self._moments[name]

    def corrections(self, name: str, rate: float) -> tuple[float, float]:
        """Counts a step of an array: the learning rate over the first moment's correction, and the root of the
        second's.
        """
        moments, (beta1, beta2) = self._moments[name], self.betas
        moments.count += 1
        return rate / (1.0 - beta1**moments.count), (1.0 - beta2**moments.count) ** 0.5

    def keep(self, name: str, rows: NDArray[Any]) -> None:
        """Drops the moments of all rows but these (a mask or indices)."""
        if (moments := self._moments.get(name)) is not None:
            moments.mean, moments.square = moments.mean[rows], moments.square[rows]

    def add(self, name: str, count: int) -> None:
        """Appends the moments of new rows: zeros."""
        if (moments := self._moments.get(name)) is not None:
            fresh = np.zeros((count, *moments.mean.shape[1:]), np.float32)
            moments.mean, moments.square = (np.concatenate([m, fresh]) for m in (moments.mean, moments.square))
