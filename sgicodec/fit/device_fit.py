"""A fit of the default profile whose arrays stay on a GPU: a step is one graph, and two numbers come back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.cuda.gpu import Gpu
from sgicodec.cuda.tiles import MOST_CHANNELS
from sgicodec.fit.adam import Adam
from sgicodec.fit.device_step import DeviceStep, StepKind
from sgicodec.fit.fused_step import REFRESH, ROUNDINGS, FusedStep, NoiseKey, Reuse, neighbours_of, reuse_of
from sgicodec.fit.parameters import Parameters
from sgicodec.fit.pyramid import Level
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import Rounding

__all__ = ["DeviceFit"]

F32 = NDArray[np.float32]


class DeviceFit:
    """What moves all that trains of `parameters`, on `gpu`, as `FusedStep` and `Adam` do on the CPU.

    The host's arrays are as old as the last `fetch`. Who changes them calls `put`, or `set_layout` where seeds have
    come or gone. Same input, same bytes, on one GPU.
    """

    def __init__(self, spec: ModelSpec, seed: int, gpu: Gpu, parameters: Parameters, adam: Adam, cutoff: float) -> None:
        self.spec, self.seed, self.gpu, self.cutoff = spec, seed, gpu, cutoff
        self.parameters, self.adam = parameters, adam
        self.age = 0
        self._levels: dict[int, tuple[Level, dict[str, Any]]] = {}
        self._step: DeviceStep | None = None

    @staticmethod
    def can_run(spec: ModelSpec) -> bool:
        """Whether the kernels have this model: what the native step has, up to 4 channels and 64 hidden units."""
        narrow = spec.channels <= MOST_CHANNELS and spec.context.hidden <= DeviceStep.most_hidden
        return FusedStep.can_run(spec) and narrow

    def set_layout(self, layout: SeedLayout, quality: int) -> None:
        """Prepares everything that depends on where the seeds are, and takes the host's arrays."""
        self.gpu.use()
        self._step = None  # its memory is free before there is more
        self._levels = {}
        neighbour = neighbours_of(self.spec.context, layout)
        self._step = DeviceStep(self.gpu, self.spec, layout, neighbour, quality, self.cutoff)
        self.put()
        self.age = 0

    def put(self) -> None:
        """Takes the host's arrays."""
        self.gpu.use()
        step, context = self._held, self.parameters.context
        for name, array in self._arrays().items():
            moments = self.adam.moments(name, array)
            step.put(name, array, moments.mean, moments.square)
        step.put_shared(self.parameters.steps, context.first, context.rest, context.difference, context.trains)

    def fetch(self) -> None:
        """Brings what trains back to the host's arrays."""
        self.gpu.use()
        for name, array in self._arrays().items():
            moments = self.adam.moments(name, array)
            array[:], moments.mean[:], moments.square[:] = self._held.take(name)

    def run(
        self, rounding: Rounding, number: int, level: Level, lmbda: float, rates: dict[str, float]
    ) -> tuple[float, float]:
        """Step `number`: squared error without weights, and bits; everything has moved at its learning rate."""
        self.gpu.use()
        context, key = self.parameters.context, NoiseKey.of(self.seed, number)
        reuse = Reuse.NOTHING if rounding == "none" else reuse_of(self.age, rounding, context)
        self.age = (self.age + 1) % REFRESH if rounding != "none" else 0
        moved = [name for name in self._arrays() if rounding != "none" or name in self.parameters.seeds.values]
        corrected = [self.adam.corrections(name, rates[name]) for name in moved]
        numbers = self._held.numbers(key, lmbda, self.adam, corrected)
        kind = StepKind(ROUNDINGS[rounding], reuse, lmbda > 0 and context.difference is not None, tuple(moved))
        return self._held.run(kind, level.scale, self._level(level), numbers)

    def seed_bits(self) -> F32:
        """Bits of every seed in the last step [N]."""
        return self._held.bits()

    @property
    def _held(self) -> DeviceStep:
        if self._step is None:
            raise RuntimeError("a fit on a GPU has no layout yet")
        return self._step

    def _arrays(self) -> dict[str, F32]:
        return self.parameters.trained()

    def _level(self, level: Level) -> dict[str, Any]:
        """A level's samples and weights on the GPU, kept from step to step."""
        if id(level) not in self._levels:
            held = {"target": self.gpu.put(level.samples)}
            if level.weights is not None:
                held["weights"] = self.gpu.put(level.weights)
            self._levels[id(level)] = level, held
        return self._levels[id(level)][1]
