"""The search: sweeps, the base layer, what they teach about steps and scales, dropping; the best outcome is kept."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.device import Device
from sgicodec.rdoq.adaptation import fitted_scales, with_coarser_steps
from sgicodec.rdoq.base_layer import with_better_base
from sgicodec.rdoq.coordinate_descent import Symbols, sweep
from sgicodec.rdoq.objective import Cost, Scene
from sgicodec.rdoq.pruning import without_losers
from sgicodec.rdoq.settings import RefineSettings

__all__ = ["Refined", "Refiner"]


@dataclass(frozen=True)
class Refined:
    """A model whose attributes lie where they will be coded, and what it costs as coded and drawn."""

    model: TileModel
    cost: Cost


class Refiner:
    """Refines one model, which was fitted for λ = `lmbda` or came out of another search, sweep by sweep.

    Another λ in a sweep moves along the curve of rate and distortion: twice λ means steps coarser by half an octave,
    dearer bits and fewer seeds. Same bytes for any number of threads.
    """

    def __init__(
        self,
        header: Header,
        model: TileModel,
        picture: NDArray[np.float32],
        lmbda: float,
        settings: RefineSettings | None = None,
        device: Device | None = None,
    ) -> None:
        self.scene = Scene(header, np.ascontiguousarray(picture, np.float32), device or Device())
        self.settings = settings or RefineSettings()
        self.fitted, self.fitted_lmbda = model, lmbda
        self._restart()

    def _restart(self) -> None:
        self.model, self.lmbda, self.sweeps = self.fitted, self.fitted_lmbda, 0
        self._found: Symbols | None = None

    def sweep(self, lmbda: float) -> Refined:
        """One sweep for λ, on from the last one, after what that taught: scales once, and which seeds do not pay."""
        scene, settings, model = self.scene, self.settings, self.model
        if self._found is not None:
            if self.sweeps == 1:
                model = replace(model, networks=fitted_scales(scene.header.spec, model.networks, self._found))
            worth = lmbda * settings.drop * (self._found.bits + settings.position_bits)
            model = without_losers(scene, model, worth)
        octaves = 0.5 * math.log2(lmbda / self.lmbda) + (settings.coarser if self.sweeps == 0 else 0.0)
        if octaves:
            model = replace(model, networks=with_coarser_steps(model.networks, octaves))
        model, self._found = sweep(scene, model, lmbda, settings)
        if settings.base:
            model = with_better_base(scene, model, lmbda)
        self.model, self.lmbda = model, lmbda
        self.sweeps += 1
        return Refined(model, scene.cost(model))

    def at(self, lmbda: float, sweeps: int | None = None, until: float = math.inf) -> Refined:
        """The best model that so many sweeps from the start find for λ; none that costs more than what there was.

        Ends early where another sweep would not be done by `until`, a value of time.monotonic().
        """
        self._restart()
        best = Refined(self.fitted, self.scene.cost(self.fitted))
        for _ in range(self.settings.sweeps if sweeps is None else sweeps):
            started = time.monotonic()
            found = self.sweep(lmbda)
            if found.cost.at(lmbda) < best.cost.at(lmbda):
                best = found
            if 2 * time.monotonic() - started > until:
                break
        return best
