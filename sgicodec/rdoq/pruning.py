"""Seeds that are not worth their bits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import drop_gaussians
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.raster.backend import DEFAULT_CUTOFF
from sgicodec.rdoq.objective import Scene, joined, with_values

__all__ = ["without_losers"]


def without_losers(scene: Scene, model: TileModel, worth: NDArray[np.float64]) -> TileModel:
    """The model without seeds whose going costs less squared error than their `worth` [N].

    The faintest are looked at first, each with those before it gone. One seed stays in any case.
    """
    means, covariances, colours = scene.gaussians(model)
    spread = np.sqrt(np.maximum(covariances[:, 0] * covariances[:, 2] - covariances[:, 1] ** 2, 0))
    energy = np.square(colours).sum(axis=1) * spread
    order = np.argsort(energy / np.maximum(worth, 1e-30), kind="stable")
    dropped = np.zeros(len(order), bool)
    drop_gaussians(
        scene.residual(model),
        means[order],
        covariances[order],
        colours[order],
        worth[order].astype(np.float32),
        DEFAULT_CUTOFF,
        scene.device.threads,
        scene.device.isa,
        dropped,
    )
    keep = np.ones(len(order), bool)
    keep[order] = ~dropped
    keep[order[-1]] |= not keep.any()
    return with_values(scene.header.spec, replace(model, layout=model.layout.take(keep)), joined(model)[keep])
