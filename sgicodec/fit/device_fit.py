"""A fit of the default profile whose arrays stay on a GPU: a step is one graph, and two numbers come back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.cuda.gpu import Gpu
from sgicodec.cuda.tiles import MAX_CHANNELS
from sgicodec.fit.adam import Adam
from sgicodec.fit.context_weights import float_weights
from sgicodec.fit.device_seeds import energy_of, moved, residual_sums
from sgicodec.fit.device_step import DeviceStep, StepKind
from sgicodec.fit.fused_step import REFRESH, ROUNDINGS, FusedStep
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.parameters import Parameters
from sgicodec.fit.pyramid import Level
from sgicodec.model.context import neighbour_table
from sgicodec.model.layout import ROOT_LOG, CellSums, SeedLayout, cell_sums, sums_by_level
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import Rounding

__all__ = ["DeviceFit"]

F32 = NDArray[np.float32]


class DeviceFit:
    """What moves all that trains of `parameters`, on `gpu`, as `FusedStep` and `Adam` do on the CPU.

    The host's arrays are as old as the last `fetch`. Who changes them calls `put`; where seeds have come or gone,
    `rearrange`. Same input, same bytes, on one GPU.
    """

    def __init__(
        self,
        spec: ModelSpec,
        seed: int,
        networks: Sequence[IntNetwork],
        gpu: Gpu,
        parameters: Parameters,
        adam: Adam,
        cutoff: float,
    ) -> None:
        self.spec, self.seed, self.gpu, self.cutoff = spec, seed, gpu, cutoff
        self._weights = float_weights(networks)
        self.parameters, self.adam = parameters, adam
        self.age = 0
        self._levels: dict[float, tuple[Level, dict[str, Any]]] = {}
        self._counted: tuple[Level, dict[int, Any]] | None = None
        self._step: DeviceStep | None = None

    @staticmethod
    def can_run(spec: ModelSpec) -> bool:
        """Whether the kernels have this model: what the native step has, up to 4 channels."""
        return FusedStep.can_run(spec) and spec.channels <= MAX_CHANNELS

    def set_layout(self, layout: SeedLayout, quality: int) -> None:
        """Prepares everything that depends on where the seeds are, and takes the host's arrays."""
        self.gpu.use()
        self._step = self._step_of(layout, quality)
        self.put()
        self.age = 0

    def rearrange(self, layout: SeedLayout, quality: int, rows: NDArray[np.intp], fresh: dict[str, F32]) -> None:
        """Other seeds: those of `rows`, and for −1 − i row i of `fresh`. What stays does not leave the GPU; the host's
        arrays have as many rows already, and are as old as before.
        """
        self.gpu.use()
        trained = moved(self._held.trained(), rows.astype(np.int32), fresh)
        self._step = None  # its memory is free before there is more
        self._step = self._step_of(layout, quality)
        self._step.adopt(trained)
        self.age = 0

    def energy(self) -> F32:
        """`SeedSet.energy` of the values of now."""
        self.gpu.use()
        return energy_of(self.gpu, *self._held.exact_gaussians(), len(self.parameters.seeds))

    def residual_sums(self, level: Level) -> CellSums:
        """`cell_sums` of what the values of now lack of a level at full scale, but for the squares."""
        self.gpu.use()
        held = self._level(level)
        values = residual_sums(self._held.exact_image(held), held["target"], held.get("weights"))
        if self._counted is None or self._counted[0] is not level:
            self._counted = level, cell_sums(level.samples[:1], ROOT_LOG, level.weights).weights
        return CellSums(sums_by_level(values.astype(np.float64), ROOT_LOG), {}, self._counted[1])

    def put(self) -> None:
        """Takes the host's arrays."""
        self.gpu.use()
        for name, array in self._arrays().items():
            moments = self.adam.moments(name, array)
            self._held.put(name, array, moments.mean, moments.square)

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
        key, predicts = NoiseKey.of(self.seed, number), rounding != "none" and self.age == 0
        self.age = (self.age + 1) % REFRESH if rounding != "none" else 0
        moved = [name for name in self._arrays() if rounding != "none" or name in self.parameters.seeds.values]
        corrected = [self.adam.corrections(name, rates[name]) for name in moved]
        numbers = self._held.numbers(key, lmbda, self.adam, corrected)
        kind = StepKind(ROUNDINGS[rounding], predicts, tuple(moved))
        return self._held.run(kind, level.scale, self._level(level), numbers)

    @property
    def _held(self) -> DeviceStep:
        if self._step is None:
            raise RuntimeError("a fit on a GPU has no layout yet")
        return self._step

    def _arrays(self) -> dict[str, F32]:
        return self.parameters.trained()

    def _step_of(self, layout: SeedLayout, quality: int) -> DeviceStep:
        neighbour = neighbour_table(self.spec.context, layout)
        return DeviceStep(self.gpu, self.spec, self._weights, layout, neighbour, quality, self.cutoff)

    def _level(self, level: Level) -> dict[str, Any]:
        """A level's samples and weights on the GPU, kept from step to step; others of its scale go."""
        if level.scale not in self._levels or self._levels[level.scale][0] is not level:
            held = {"target": self.gpu.put(level.samples)}
            if level.weights is not None:
                held["weights"] = self.gpu.put(level.weights)
            self._levels[level.scale] = level, held
        return self._levels[level.scale][1]
