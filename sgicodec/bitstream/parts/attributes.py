"""Seed attributes: symbols under the distributions that MLP_p predicts, pass after pass, group after group.

`AttributeQuantiser` finds the symbols and what a decoder makes of them; `write_attributes` codes them. Everything from
decoded symbols to the next distribution is integer arithmetic, so that a reader (native/bitstream/read_attributes.cpp)
agrees on every machine (docs/format.md, "Context model").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import MAX_MAGNITUDE, SCALES
from sgicodec.device import ONE_THREAD
from sgicodec.model.context import HashGrid, hash_inputs, input_count, nearest_by_pass, output_count
from sgicodec.model.layout import SeedLayout
from sgicodec.model.native import SeedInputs, quantisers, summarise, write_own_inputs
from sgicodec.model.neighbours import nearest_seeds
from sgicodec.model.network import IntNetwork, Prediction
from sgicodec.model.quantization import DEAD_ZONE, FRACTION_BITS, quantize
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, follows_amplitude

__all__ = ["AttributeQuantiser", "QuantisedAttributes", "write_attributes"]

I16 = NDArray[np.int16]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
F64 = NDArray[np.float64]


class SymbolRun(NamedTuple):
    """Symbols [n, size] of an attribute group, and the index of each one's frequency table."""

    group: str
    symbols: I64
    tables: I16


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


def _shift(value: Any, bits: int) -> Any:
    return value >> bits


@dataclass(frozen=True)
class AttributeQuantiser:
    """What is known before the first attribute: the model's kind, its seeds and its networks."""

    spec: ModelSpec
    layout: SeedLayout
    size: tuple[int, int]
    plan: StepPlan
    networks: tuple[IntNetwork, ...]
    hash_tables: list[I64]
    quality: int
    family: int

    def quantise(self, values: dict[str, F64]) -> QuantisedAttributes:
        """The symbols of the float attributes `values` by group [N, size], and what they decode to."""
        runs: list[SymbolRun] = []
        context, layout = self.spec.context, self.layout
        decoded = np.zeros((len(layout), self.spec.attributes), np.int64)
        seeds = SeedInputs(layout, self.quality, ONE_THREAD)
        widths = [input_count(self.spec, number) for number in range(len(context.steps))]
        if context.hash_resolutions:
            grid = HashGrid.at(context, layout, *self.size)
            signs = [2 * bits - 1 for bits in self.hash_tables]
        for members, neighbours in nearest_by_pass(context, layout, nearest_seeds):
            if not len(members):
                continue
            inputs = np.empty((len(members), max(widths)), np.int16)
            seeds.write(members, neighbours, inputs)
            if context.hash_resolutions:
                hashed = hash_inputs(grid, members, signs, grid.weight, np.concatenate, _shift)
                inputs[:, widths[0] - hashed.shape[1] : widths[0]] = hashed
            self._quantise_pass(members, inputs, widths, values, decoded, runs)
            if context.neighbours:
                seeds.summary[members] = summarise(self.spec, decoded, members, ONE_THREAD)[0]
        return QuantisedAttributes(decoded, runs)

    def _quantise_pass(
        self,
        members: I64,
        inputs: I16,
        widths: list[int],
        values: dict[str, F64],
        decoded: I64,
        runs: list[SymbolRun],
    ) -> None:
        """Adds the seeds `members` to `decoded` and `runs`; inputs [n, most] hold what all steps see, the first
        widths[0] columns.
        """
        amplitude = None
        for number, step in enumerate(self.spec.context.steps):
            if number:
                summary, amplitude = summarise(self.spec, decoded, members, ONE_THREAD)
                write_own_inputs(summary, number, widths[0], inputs, ONE_THREAD)
            prediction = self.networks[number].predict(inputs[:, : widths[number]])
            start = 0
            for position, name in enumerate(step):
                units = slice(start, start + output_count(self.spec, name))
                start = units.stop
                part = Prediction(
                    prediction.mean[:, units], prediction.scale[:, units], prediction.refine[:, position : position + 1]
                )
                known = amplitude if follows_amplitude(self.spec, name) else None
                runs.append(self._quantise_group(name, members, part, known, values[name][members], decoded))

    def _quantise_group(
        self,
        name: str,
        members: I64,
        prediction: Prediction,
        amplitude: I32 | None,
        values: F64,
        decoded: I64,
    ) -> SymbolRun:
        known = quantisers(self.spec, self.plan, name, prediction, amplitude, self.layout.log_size[members], ONE_THREAD)
        dead_zone = DEAD_ZONE if self.family else 0.0  # a Laplacian's: Gaussian attributes are fitted without
        symbols = quantize(values, known.mean, known.step, known.scale, dead_zone)
        symbols = np.clip(symbols, -MAX_MAGNITUDE, MAX_MAGNITUDE)
        known.decode(symbols.astype(np.int32), members, self.spec.group(name).start, decoded, ONE_THREAD)
        return SymbolRun(name, symbols, known.scale + np.int16(SCALES * self.family))
