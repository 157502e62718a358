"""The search: sweeps, what they teach about steps and scales, and dropping, with the best outcome kept."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.tile import TileModel
from sgicodec.model.processor import Processor
from sgicodec.refine.adapt import fitted_scales, with_coarser_steps
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
        target: NDArray[np.float32],
        lmbda: float,
        settings: RefineSettings | None = None,
        processor: Processor | None = None,
    ) -> None:
        self.scene = Scene(header, np.ascontiguousarray(target, np.float32), processor or Processor(threads=0))
        self.fitted, self.lmbda, self.settings = model, lmbda, settings or RefineSettings()

    def at(self, lmbda: float, sweeps: int | None = None) -> Refined:
        """The best model found for λ; at the fit's own, none that costs more than the fit as it is."""
        settings = self.settings
        octaves = settings.coarser + 0.5 * math.log2(lmbda / self.lmbda)
        model = replace(self.fitted, networks=with_coarser_steps(self.fitted.networks, octaves))
        best = Refined(self.fitted, self.scene.cost(self.fitted))
        last = (settings.sweeps if sweeps is None else sweeps) - 1
        for number in range(last + 1):
            model, found = sweep(self.scene, model, lmbda, settings)
            cost = self.scene.cost(model)
            if cost.at(lmbda) < best.cost.at(lmbda):
                best = Refined(model, cost)
            if number == last:
                break
            if number == 0:
                networks = fitted_scales(self.scene.header.spec, model.networks, found)
                model = replace(model, networks=networks)
            worth = lmbda * settings.drop * (found.bits + settings.position_bits)
            model = without_losers(self.scene, model, worth)
        return best


def refine(
    header: Header,
    model: TileModel,
    target: NDArray[np.float32],
    lmbda: float,
    settings: RefineSettings | None = None,
    processor: Processor | None = None,
) -> Refined:
    """The best model found for the λ of the fit. target [C, H, W]: the picture less its base layer, samples in 0..1."""
    return Refiner(header, model, target, lmbda, settings, processor).at(lmbda)
