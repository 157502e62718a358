"""Seed attributes: symbols under the distributions that MLP_p predicts, pass after pass, group after group.

`quantise_attributes` finds the symbols and what a decoder makes of them; `write_attributes` codes them. Native code
goes through the passes, in one way for writing and reading (native/bitstream/attributes.hpp). Everything from decoded
symbols to the next distribution is integer arithmetic, so that readers agree on every machine (docs/format.md,
"Context model").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import SCALES
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.device import ONE_THREAD
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import IntNetwork
from sgicodec.model.quantization import DEAD_ZONE, DEAD_ZONE_LIMIT, FRACTION_BITS, PER_OCTAVE, SCALE_ZERO
from sgicodec.model.steps import StepPlan

__all__ = ["QuantisedAttributes", "SeedCoding", "quantise_attributes", "write_attributes"]

I16 = NDArray[np.int16]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
F64 = NDArray[np.float64]


class SymbolRun(NamedTuple):
    """Symbols [n, size] of an attribute group, indices of their frequency tables, and their steps in units of 2^-24."""

    group: str
    symbols: I32
    tables: I16
    steps: I64


@dataclass(frozen=True)
class QuantisedAttributes:
    """decoded [N, d_A]: attributes as a decoder will have them, in units of 2^-24, in the layout's order. runs: the
    symbols that say so, in the order in which they are coded.
    """

    decoded: I64
    runs: list[SymbolRun]

    @property
    def values(self) -> F64:
        """Decoded attributes [N, d_A] as floats."""
        return np.multiply(self.decoded, 2.0**-FRACTION_BITS, dtype=np.float64)


def write_attributes(writer: SymbolWriter, quantised: QuantisedAttributes) -> None:
    """Codes the symbols, each group's booked to its name."""
    for run in quantised.runs:
        with writer.part(run.group):
            writer.code(run.symbols, run.tables)


class SeedCoding(NamedTuple):
    """How the seeds of a tile are coded, as native code takes it."""

    header: bytes
    corner: I32
    log_size: NDArray[np.int8]
    plan: list[tuple[I64, int]]
    networks: list[tuple[I64, I64, I64, I64, int]]

    @classmethod
    def of(cls, header: Header, layout: SeedLayout, plan: StepPlan, networks: tuple[IntNetwork, ...]) -> SeedCoding:
        """That of a layout's seeds under these steps and networks."""
        return cls(
            encode_header(header),
            np.ascontiguousarray(layout.corner),
            np.ascontiguousarray(layout.log_size),
            [(np.ascontiguousarray(plan.base[group.name]), plan.gamma[group.name]) for group in header.spec.groups],
            [(*network.arrays, network.shift) for network in networks],
        )


def quantise_attributes(
    header: Header,
    layout: SeedLayout,
    plan: StepPlan,
    networks: tuple[IntNetwork, ...],
    hash_tables: list[I64],
    values: dict[str, F64],
) -> QuantisedAttributes:
    """The symbols of the float attributes `values` by group [N, size], and what they decode to.

    Decisions lean towards zero by what the bits are worth, `DEAD_ZONE` for a scale of one step, under a Laplacian:
    Gaussian attributes are fitted without. A decoder need not know.
    """
    names = [group.name for group in header.spec.groups]
    dead_zone = DEAD_ZONE if header.family else 0.0
    octaves = (SCALE_ZERO - np.arange(SCALES)) / PER_OCTAVE
    signs = [table.reshape(-1) for table in hash_tables]
    decoded, runs = _native.quantise_attributes(
        *SeedCoding.of(header, layout, plan, networks),
        np.concatenate(signs).astype(np.uint8) if signs else np.empty(0, np.uint8),
        np.concatenate([values[name] for name in names], axis=1, dtype=np.float64),
        np.minimum(dead_zone * 2.0**octaves, DEAD_ZONE_LIMIT),
        ONE_THREAD.threads,
        ONE_THREAD.isa,
    )
    return QuantisedAttributes(decoded, [SymbolRun(names[run[0]], *run[1:]) for run in runs])
