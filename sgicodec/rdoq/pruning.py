"""Pruning: seeds whose bits cost more than the error that they save go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import prune_gaussians
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.raster.backend import DEFAULT_CUTOFF
from sgicodec.rdoq.objective import Objective, joined, with_values

__all__ = ["without_pruned_seeds"]


def without_pruned_seeds(
    objective: Objective, model: TileModel, residual: NDArray[np.float32], price: NDArray[np.float64]
) -> TileModel:
    """The model without seeds whose going costs less error than their `price` [N].

    `residual` is what the model leaves, as `Objective.residual` has it, and afterwards what the result leaves. The
    faintest are looked at first, each with those before it gone. One seed stays in any case.
    """
    means, covariances, colours = objective.gaussians(model)
    spread = np.sqrt(np.maximum(covariances[:, 0] * covariances[:, 2] - covariances[:, 1] ** 2, 0))
    energy = np.square(colours).sum(axis=1) * spread
    order = np.argsort(energy / np.maximum(price, 1e-30), kind="stable")
    pruned = np.zeros(len(order), bool)
    prune_gaussians(
        residual,
        objective.padded_weights,
        means[order],
        covariances[order],
        colours[order],
        price[order].astype(np.float32),
        DEFAULT_CUTOFF,
        objective.device.threads,
        objective.device.isa,
        pruned,
    )
    keep = np.ones(len(order), bool)
    keep[order] = ~pruned
    keep[order[-1]] |= not keep.any()
    return with_values(objective.header.spec, replace(model, layout=model.layout.take(keep)), joined(model)[keep])
