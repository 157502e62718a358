"""Coordinate descent: passes that search every seed's symbols once, in the order in which they are coded. Same bytes
for any number of threads.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sgicodec._native import search_seeds
from sgicodec.arrays import F32, F64
from sgicodec.bitstream.header import encode_header
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.model.quantization import FRACTION_BITS
from sgicodec.raster.backend import DEFAULT_CUTOFF
from sgicodec.rdoq.objective import Objective, with_values


@dataclass(frozen=True)
class RdoqSettings:
    """How RDOQ follows a fit. What each part gains was measured: docs/notes/2026-11-rdoq.md."""

    passes: int = 6
    """Times that all seeds are gone through."""
    deep: int = 2
    """Choices of a seed's colours that are followed to its shape and offset."""


def searched(
    objective: Objective,
    model: TileModel,
    lmbda: float,
    settings: RdoqSettings,
    ending: Callable[[], bool] = lambda: False,
) -> TileModel:
    """The model that passes find, whose attributes lie where they will be coded. Nobody looks at what a pass costs: the
    last one is as good as the best, within 0.2 % (docs/notes/2026-11-rdoq.md).

    Ends early before a pass where `ending` says so.
    """
    if ending():
        return model
    residual = objective.residual(model)
    for done in range(settings.passes):
        if done and ending():
            break
        model, _ = descend(objective, model, residual, lmbda, settings)
    return model


def descend(
    objective: Objective, model: TileModel, residual: F32, lmbda: float, settings: RdoqSettings
) -> tuple[TileModel, F64]:
    """Searches the symbols of all seeds, pass by pass, each with the others as they are by then. Returns also by how
    much each changed squared error plus price [N].

    `residual` is what the model leaves, as `Objective.residual` has it, and afterwards what the result leaves. The
    result's attributes lie on the grids on which they will be coded: rounding leaves them alone.
    """
    header, device = objective.header, objective.device
    decoded, change = search_seeds(
        encode_header(header),
        model,
        residual,
        objective.padded_weights,
        lmbda,
        DEFAULT_CUTOFF,
        settings.deep,
        device.threads,
        device.isa,
    )
    values = np.ldexp(decoded.astype(np.float64), -FRACTION_BITS)
    return with_values(header.spec, model, values), change
