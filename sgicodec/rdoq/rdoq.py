"""RDOQ as a whole: passes over seeds and base layer, steps and scales, pruning; the best outcome is kept."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.device import Device
from sgicodec.metrics.distortion import QuadraticReference, Reference
from sgicodec.rdoq.adaptation import fitted_scales, with_coarser_steps
from sgicodec.rdoq.base_layer import with_optimised_base
from sgicodec.rdoq.coordinate_descent import Symbols, descend
from sgicodec.rdoq.objective import Cost, Objective
from sgicodec.rdoq.pruning import without_pruned_seeds
from sgicodec.rdoq.settings import RdoqSettings

__all__ = ["Rdoq", "RdoqResult"]


@dataclass(frozen=True)
class RdoqResult:
    """A model whose attributes lie where they will be coded, and what it costs as coded and drawn."""

    model: TileModel
    cost: Cost


class Rdoq:
    """RDOQ of one model, which was fitted for λ = `lmbda` or came out of another RDOQ, pass by pass.

    Another λ in a pass moves along the curve of rate and distortion: twice λ means steps coarser by half an octave,
    dearer bits and fewer seeds. Same bytes for any number of threads.
    """

    def __init__(
        self,
        header: Header,
        model: TileModel,
        picture: NDArray[np.float32],
        lmbda: float,
        settings: RdoqSettings | None = None,
        device: Device | None = None,
        reference: Reference | None = None,
    ) -> None:
        unit = np.ascontiguousarray(picture, np.float32)
        self.objective = Objective(header, unit, device or Device(), reference or QuadraticReference())
        self.settings = settings or RdoqSettings()
        self.fitted, self.fitted_lmbda = model, lmbda
        self._restart()

    def _restart(self) -> None:
        self.model, self.lmbda, self.passes = self.fitted, self.fitted_lmbda, 0
        self._found: Symbols | None = None
        self._residual: NDArray[np.float32] | None = None

    def descend(self, lmbda: float) -> RdoqResult:
        """One pass for λ, on from the last one, after what that taught: scales once, and which seeds are pruned."""
        model = self._pass(lmbda)
        cost, self._residual = self.objective.measured(model)
        return RdoqResult(model, cost)

    def once(self, lmbda: float) -> TileModel:
        """What one pass from the start finds for λ, without a look at what it costs: a pass after a fit gains."""
        self._restart()
        return self._pass(lmbda)

    def _pass(self, lmbda: float) -> TileModel:
        objective, settings, model, residual = self.objective, self.settings, self.model, self._residual
        if residual is None:
            residual = objective.residual(model)
        if self._found is not None:
            if self.passes == 1:
                model = replace(model, networks=fitted_scales(objective.header.spec, model.networks, self._found))
            price = lmbda * settings.drop * (self._found.bits + settings.position_bits)
            model = without_pruned_seeds(objective, model, residual, price)
        octaves = 0.5 * math.log2(lmbda / self.lmbda) + (settings.coarser if self.passes == 0 else 0.0)
        if octaves:
            model = replace(model, networks=with_coarser_steps(model.networks, octaves))
        model, self._found = descend(objective, model, residual, lmbda, settings)
        if settings.base:
            model = with_optimised_base(objective, model, residual, lmbda)
        self.model, self.lmbda = model, lmbda
        self.passes += 1
        return model

    def at(
        self,
        lmbda: float,
        passes: int | None = None,
        ending: Callable[[], bool] = lambda: False,
    ) -> RdoqResult:
        """The best model that `passes` passes from the start find for λ; none that costs more than what there was.

        Ends early before a pass where `ending` says so.
        """
        self._restart()
        best = RdoqResult(self.fitted, self.objective.cost(self.fitted))
        for _ in range(self.settings.passes if passes is None else passes):
            if ending():
                break
            found = self.descend(lmbda)
            if found.cost.at(lmbda) < best.cost.at(lmbda):
                best = found
        return best
