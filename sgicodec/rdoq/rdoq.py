"""RDOQ as a whole: passes over seeds and base layer, pruning between them. Same bytes for any number of threads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.rdoq.adaptation import fitted_scales, with_coarser_steps
from sgicodec.rdoq.base_layer import with_optimised_base
from sgicodec.rdoq.coordinate_descent import F32, Symbols, descend
from sgicodec.rdoq.objective import Objective
from sgicodec.rdoq.pruning import without_pruned_seeds
from sgicodec.rdoq.settings import RdoqSettings

__all__ = ["searched"]


def searched(
    objective: Objective,
    model: TileModel,
    lmbda: float,
    settings: RdoqSettings,
    ending: Callable[[int], bool] = lambda done: False,
) -> TileModel:
    """The model that passes find, whose attributes lie where they will be coded. Nobody looks at what a pass costs: the
    last one is as good as the best, within 0.2 % (docs/notes/2026-11-rdoq.md).

    Ends early before a pass where `ending` says so of the number of passes that are done.
    """
    residual, found = objective.residual(model), None
    for done in range(settings.passes):
        if ending(done):
            break
        if found is not None:
            residual = objective.decoded_residual(model)
            model = _taught(objective, model, residual, found, lmbda, settings, done)
        model, found = _pass(objective, model, residual, lmbda, settings, 0.0 if done else settings.coarser)
    return model


def _taught(
    objective: Objective,
    model: TileModel,
    residual: F32,
    found: Symbols,
    lmbda: float,
    settings: RdoqSettings,
    done: int,
) -> TileModel:
    """The model with what its last pass taught: scales once, and which seeds are pruned."""
    if done == 1:
        model = replace(model, networks=fitted_scales(objective.header.spec, model.networks, found))
    price = lmbda * settings.drop * (found.bits + settings.position_bits)
    return without_pruned_seeds(objective, model, residual, price)


def _pass(
    objective: Objective, model: TileModel, residual: F32, lmbda: float, settings: RdoqSettings, coarser: float
) -> tuple[TileModel, Symbols]:
    """One pass over seeds, whose steps grow by `coarser` octaves beforehand, and the base layer."""
    if coarser:
        model = replace(model, networks=with_coarser_steps(model.networks, coarser))
    model, found = descend(objective, model, residual, lmbda, settings)
    return with_optimised_base(objective, model, residual, lmbda), found
