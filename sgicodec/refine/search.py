"""The search: sweeps, the base layer, what they teach about steps and scales, dropping; the best outcome is kept."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.tile import TileModel
from sgicodec.model.processor import Processor
from sgicodec.refine.adapt import fitted_scales, with_coarser_steps
from sgicodec.refine.base import with_better_base
from sgicodec.refine.drop import without_losers
from sgicodec.refine.scene import Cost, Scene
from sgicodec.refine.settings import RefineSettings
from sgicodec.refine.sweep import sweep

__all__ = ["Refined", "Refiner", "refine"]


@dataclass(frozen=True)
class Refined:
    """A model whose attributes lie where they will be coded, and what it costs as coded and drawn."""

    model: TileModel
    cost: Cost


class Refiner:
    """Refines one fitted model, for one λ or for several.

    lmbda is what the fit was made for; asking for another one moves along the curve of rate and distortion: twice λ
    means steps coarser by half an octave, dearer bits and fewer seeds. A search for a size of file can bisect λ with
    few `sweeps` and take all of them at the end. Same bytes for any number of threads.
    """

    def __init__(
        self,
        header: Header,
        model: TileModel,
        picture: NDArray[np.float32],
        lmbda: float,
        settings: RefineSettings | None = None,
        processor: Processor | None = None,
    ) -> None:
        self.scene = Scene(header, np.ascontiguousarray(picture, np.float32), processor or Processor(threads=0))
        self.fitted, self.lmbda, self.settings = model, lmbda, settings or RefineSettings()

    def at(self, lmbda: float, sweeps: int | None = None, until: float = math.inf) -> Refined:
        """The best model found for λ; at the fit's own, none that costs more than the fit as it is.

        Ends early where another sweep would not be done by `until`, a value of time.monotonic().
        """
        scene, settings = self.scene, self.settings
        octaves = settings.coarser + 0.5 * math.log2(lmbda / self.lmbda)
        model = replace(self.fitted, networks=with_coarser_steps(self.fitted.networks, octaves))
        best = Refined(self.fitted, scene.cost(self.fitted))
        most = settings.sweeps if sweeps is None else sweeps
        for number in range(most):
            started = time.monotonic()
            model, found = sweep(scene, model, lmbda, settings)
            if settings.base:
                model = with_better_base(scene, model, lmbda)
            cost = scene.cost(model)
            if cost.at(lmbda) < best.cost.at(lmbda):
                best = Refined(model, cost)
            if number == most - 1 or 2 * time.monotonic() - started > until:
                break
            if number == 0:
                networks = fitted_scales(scene.header.spec, model.networks, found)
                model = replace(model, networks=networks)
            worth = lmbda * settings.drop * (found.bits + settings.position_bits)
            model = without_losers(scene, model, worth)
        return best


def refine(
    header: Header,
    model: TileModel,
    picture: NDArray[np.float32],
    lmbda: float,
    settings: RefineSettings | None = None,
    processor: Processor | None = None,
    until: float = math.inf,
) -> Refined:
    """The best model found for the λ of the fit. picture [C, H, W]: samples in 0..1; until: see `Refiner.at`."""
    return Refiner(header, model, picture, lmbda, settings, processor).at(lmbda, until=until)
