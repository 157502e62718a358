"""RDOQ as a whole: passes over seeds and base layer, steps and scales, pruning; the best outcome is kept."""

from __future__ import annotations

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
    """A model whose attributes lie where they will be coded, and what it costs as coded and rendered."""

    model: TileModel
    cost: Cost


class Rdoq:
    """RDOQ of one model for λ = `lmbda`, pass by pass. Same bytes for any number of threads."""

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
        self.fitted, self.lmbda = model, lmbda
        self._restart()

    def _restart(self) -> None:
        self.model, self.passes = self.fitted, 0
        self._found: Symbols | None = None
        self._residual: NDArray[np.float32] | None = None

    def once(self) -> TileModel:
        """What one pass from the start finds, without a look at what it costs: a pass after a fit gains."""
        self._restart()
        return self._pass()

    def best(self, passes: int | None = None, ending: Callable[[], bool] = lambda: False) -> RdoqResult:
        """The best model that `passes` passes from the start find; none that costs more than what there was.

        Ends early before a pass where `ending` says so.
        """
        self._restart()
        best = RdoqResult(self.fitted, self.objective.cost(self.fitted))
        for _ in range(self.settings.passes if passes is None else passes):
            if ending():
                break
            model = self._pass()
            cost, self._residual = self.objective.measured(model)
            if cost.at(self.lmbda) < best.cost.at(self.lmbda):
                best = RdoqResult(model, cost)
        return best

    def _pass(self) -> TileModel:
        """One pass, on from the last one, after what that taught: scales once, and which seeds are pruned."""
        objective, settings, model, residual = self.objective, self.settings, self.model, self._residual
        if residual is None:
            residual = objective.residual(model)
        if self._found is not None:
            if self.passes == 1:
                model = replace(model, networks=fitted_scales(objective.header.spec, model.networks, self._found))
            price = self.lmbda * settings.drop * (self._found.bits + settings.position_bits)
            model = without_pruned_seeds(objective, model, residual, price)
        if self.passes == 0 and settings.coarser:
            model = replace(model, networks=with_coarser_steps(model.networks, settings.coarser))
        model, self._found = descend(objective, model, residual, self.lmbda, settings)
        if settings.base:
            model = with_optimised_base(objective, model, residual, self.lmbda)
        self.model = model
        self.passes += 1
        return model
