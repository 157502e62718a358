"""One coordinate-descent pass: every seed's symbols searched once, in the order in which they are coded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import SymbolSearch
from sgicodec.bitstream.entropy.tables import SCALES, frequency_tables
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.model.context import input_count, nearest_by_pass, output_columns
from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.native import SeedInputs, summarise
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

    @classmethod
    def empty(cls, count: int, width: int, family: int) -> Symbols:
        """Room for `count` seeds and their attributes."""
        shape = (count, width)
        return cls(np.zeros(shape, np.int32), np.zeros(shape, np.int16), np.zeros(count), family)

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
    header, layout, device = objective.header, model.layout, objective.device
    spec, count = header.spec, len(model.layout)
    search, seeds = _search(objective, model), SeedInputs(layout, header.quality, device)
    values = joined(model)
    centre, cell = layout.centre, layout.cell
    decoded = np.zeros((count, spec.attributes), np.int64)
    coded = Symbols.empty(count, spec.attributes, header.family)
    for members, neighbours in nearest_by_pass(spec.context, layout):
        inputs = np.empty((len(members), input_count(spec, 0)), np.int16)
        seeds.write(members, neighbours, inputs)
        part = Symbols.empty(len(members), spec.attributes, header.family)
        values_found = decoded[members]
        search.search(
            residual,
            objective.weights,
            inputs,
            values[members],
            centre[members],
            cell[members],
            layout.log_size[members],
            values_found,
            part.symbols,
            part.scale,
            part.change,
            lmbda,
            DEFAULT_CUTOFF,
            settings.deep,
            settings.rounds,
        )
        decoded[members] = values_found
        coded.symbols[members], coded.scale[members], coded.change[members] = part.symbols, part.scale, part.change
        seeds.summary[members] = summarise(spec, decoded, members, device)[0]
    return with_values(spec, model, np.ldexp(decoded.astype(np.float64), -FRACTION_BITS)), coded


def _search(objective: Objective, model: TileModel) -> SymbolSearch:
    tables, spec, device = frequency_tables(), objective.header.spec, objective.device
    search = SymbolSearch(
        tables.support,
        tables.start,
        tables.symbol_bits,
        SCALES * objective.header.family,
        np.array(colour_matrix(spec.channels), np.float32),
        device.threads,
        device.isa,
    )
    for number, (group, network) in enumerate(zip(spec.groups, model.networks, strict=True)):
        columns = output_columns(spec, group.name)
        w1, b1, w2, b2 = (np.ascontiguousarray(array) for array in (network.w1, network.b1, network.w2, network.b2))
        base, gamma = np.ascontiguousarray(model.plan.base[group.name][columns]), model.plan.gamma[group.name]
        search.set_group(number, w1, b1, w2, b2, network.shift, network.predicted, base, columns, gamma)
    return search
