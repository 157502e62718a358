"""One coordinate-descent pass: every seed's symbols searched once, in the order in which they are coded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import search_seeds
from sgicodec.bitstream.entropy.tables import SCALES, frequency_tables
from sgicodec.bitstream.parts.attributes import SeedCoding
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.quantization import FRACTION_BITS
from sgicodec.raster.backend import DEFAULT_CUTOFF
from sgicodec.rdoq.objective import Objective, joined, with_values
from sgicodec.rdoq.settings import RdoqSettings

__all__ = ["Symbols", "descend"]

I16 = NDArray[np.int16]
I32 = NDArray[np.int32]
F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Symbols:
    """What a pass chose: symbols [N, d_A], scale indices of their tables [N, d_A] and, per seed [N], by how much it
    changed squared error plus price.
    """

    symbols: I32
    scale: I16
    change: F64
    family: int

    @property
    def bits(self) -> F64:
        """Bits of every seed's attributes [N]."""
        total: F64 = frequency_tables().bits(self.symbols, self.scale + SCALES * self.family).sum(axis=1)
        return total


def descend(
    objective: Objective, model: TileModel, residual: F32, lmbda: float, settings: RdoqSettings
) -> tuple[TileModel, Symbols]:
    """Searches the symbols of all seeds, pass by pass, each with the others as they are by then.

    `residual` is what the model leaves, as `Objective.residual` has it, and afterwards what the result leaves. The
    result's attributes lie on the grids on which they will be coded: rounding leaves them alone.
    """
    header, device, tables = objective.header, objective.device, frequency_tables()
    decoded, symbols, scale, change = search_seeds(
        *SeedCoding.of(header, model.layout, model.plan, model.networks),
        joined(model),
        *(tables.support, tables.start, tables.symbol_bits),
        np.array(colour_matrix(header.spec.channels), np.float32),
        residual,
        objective.padded_weights,
        lmbda,
        DEFAULT_CUTOFF,
        settings.deep,
        settings.rounds,
        device.threads,
        device.isa,
    )
    values = np.ldexp(decoded.astype(np.float64), -FRACTION_BITS)
    return with_values(header.spec, model, values), Symbols(symbols, scale, change, header.family)
