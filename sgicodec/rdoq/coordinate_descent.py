"""One coordinate-descent pass: every seed's symbols searched once, in the order in which they are coded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import search_seeds
from sgicodec.bitstream.entropy.tables import frequency_tables
from sgicodec.bitstream.parts.attributes import SeedCoding
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.model.quantization import FRACTION_BITS
from sgicodec.raster.backend import DEFAULT_CUTOFF
from sgicodec.rdoq.objective import Objective, joined, with_values
from sgicodec.rdoq.settings import RdoqSettings

__all__ = ["descend"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


def descend(
    objective: Objective, model: TileModel, residual: F32, lmbda: float, settings: RdoqSettings
) -> tuple[TileModel, F64]:
    """Searches the symbols of all seeds, pass by pass, each with the others as they are by then. Returns also by how
    much each changed squared error plus price [N].

    `residual` is what the model leaves, as `Objective.residual` has it, and afterwards what the result leaves. The
    result's attributes lie on the grids on which they will be coded: rounding leaves them alone.
    """
    header, device, tables = objective.header, objective.device, frequency_tables()
    decoded, change = search_seeds(
        *SeedCoding.of(header, model.layout, model.plan, model.networks),
        joined(model),
        *(tables.support, tables.start, tables.symbol_bits),
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
