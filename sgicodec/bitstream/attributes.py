"""Seed attributes: symbols under the distributions that MLP_p predicts, pass after pass, group after group.

The same walk writes and reads. Everything from decoded symbols to the next distribution is integer arithmetic, so the
two directions agree on every machine (docs/format.md, "Context model").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy import SymbolWalk
from sgicodec.bitstream.tables import MAX_MAGNITUDE, SCALES
from sgicodec.model.context import (
    INPUT_BITS,
    SUMMARY,
    HashGrid,
    hash_inputs,
    level_inputs,
    nearest_offset,
    neighbour_inputs,
    neighbour_table,
    output_columns,
    output_count,
    own_inputs,
    passes,
)
from sgicodec.model.layout import SeedLayout
from sgicodec.model.neighbours import nearest_seeds
from sgicodec.model.network import MEAN_BITS, IntNetwork, Prediction
from sgicodec.model.quantize import (
    FRACTION_BITS,
    PER_OCTAVE,
    SCALE_ZERO,
    amplitude_index,
    dequantize,
    quantize,
    step_fixed,
)
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, follows_amplitude

__all__ = ["AttributeCoder"]

I64 = NDArray[np.int64]
_INPUT_LIMIT = 1 << 13
_MEAN_LIMIT = 1 << 20


def _shift(value: Any, bits: int) -> Any:
    return value >> bits


@dataclass(frozen=True)
class AttributeCoder:
    """What both sides know before the first attribute: the model's kind, its seeds and its networks.

    `matmul` is there so that a test can sum in another order and still get the same symbols.
    """

    spec: ModelSpec
    layout: SeedLayout
    size: tuple[int, int]
    plan: StepPlan
    networks: tuple[IntNetwork, ...]
    hash_tables: list[I64]
    quality: int
    family: int
    matmul: Any = np.matmul

    def code(self, walk: SymbolWalk, values: dict[str, NDArray[np.float64]] | None) -> I64:
        """Writes the float attributes `values` by group [N, size], or reads if None. Returns the decoded attributes
        [N, d_A] in units of 2^-24, in the layout's order.
        """
        context, layout = self.spec.context, self.layout
        decoded = np.zeros((len(layout), self.spec.attributes), np.int64)
        summary = np.zeros((len(layout), SUMMARY), np.int64)
        everything = level_inputs(layout, self.quality)
        if context.neighbours:
            table, present = neighbour_table(context, layout, nearest_seeds)
            offset = nearest_offset(layout, table)
        if context.hash_resolutions:
            grid = HashGrid.at(context, layout, *self.size)
            signs = [2 * bits - 1 for bits in self.hash_tables]
        sizes = layout.log_size.astype(np.int64)
        for members in passes(context, layout):
            if not len(members):
                continue
            blocks = [everything[members]]
            if context.neighbours:
                beside = table[members], present[members], (sizes[members], sizes), offset[members]
                blocks.append(neighbour_inputs(summary, *beside, np.concatenate, _shift))
            if context.hash_resolutions:
                blocks.append(hash_inputs(grid, members, signs, grid.weight, np.concatenate, _shift))
            self._code_pass(walk, members, np.concatenate(blocks, -1), values, decoded)
            if context.neighbours:
                summary[members] = self._summary(decoded[members])
        return decoded

    def _code_pass(
        self,
        walk: SymbolWalk,
        members: I64,
        common: I64,
        values: dict[str, NDArray[np.float64]] | None,
        decoded: I64,
    ) -> None:
        amplitude = None
        for number, step in enumerate(self.spec.context.steps):
            inputs = common
            if number:
                inputs = np.concatenate(
                    [common, own_inputs(self._summary(decoded[members]), number, np.concatenate)], -1
                )
            prediction = self.networks[number].predict(inputs, self.matmul)
            start = 0
            for position, name in enumerate(step):
                units = output_count(self.spec, name)
                part = Prediction(
                    prediction.mean[:, start : start + units],
                    prediction.scale[:, start : start + units],
                    prediction.refine[:, position],
                )
                start += units
                group = self.spec.group(name)
                if follows_amplitude(self.spec, name) and amplitude is None:
                    amplitude = amplitude_index(decoded[members][:, self.spec.group("colour").columns])
                given = None if values is None else values[name][members]
                known = amplitude if follows_amplitude(self.spec, name) else None
                with walk.part(name):
                    decoded[members, group.columns] = self._code_group(walk, name, members, part, known, given)

    def _code_group(
        self,
        walk: SymbolWalk,
        name: str,
        members: I64,
        prediction: Prediction,
        amplitude: I64 | None,
        values: NDArray[np.float64] | None,
    ) -> I64:
        base = self.plan.base_index(self.spec, name, self.layout.log_size[members])
        index = self.plan.refined_index(name, base, amplitude, prediction.refine)
        columns = output_columns(self.spec, name)
        step = step_fixed(index)
        mean = (np.clip(prediction.mean[:, columns], -_MEAN_LIMIT, _MEAN_LIMIT) * step_fixed(base)) >> MEAN_BITS
        scale = np.clip(SCALE_ZERO + prediction.scale[:, columns] + base - index, 0, SCALES - 1)
        symbols = None
        if values is not None:
            symbols = np.clip(quantize(values, mean, step, scale), -MAX_MAGNITUDE, MAX_MAGNITUDE)
        coded = walk.code(symbols, scale + SCALES * self.family)
        return dequantize(coded.astype(np.int64), mean, step)

    def _summary(self, decoded: I64) -> I64:
        """Summaries [n, SUMMARY] in input units; the mirror of what a fit computes in floats."""
        spec, k = self.spec, self.spec.per_seed
        colour = decoded[:, spec.group("colour").columns]
        shape = decoded[:, spec.group("shape").columns]
        mixed = colour.reshape(-1, k, spec.channels).sum(axis=1) // k
        colours = np.zeros((len(decoded), 3), np.int64)
        shown = 3 if spec.channels >= 3 else 1
        colours[:, :shown] = mixed[:, :shown] >> (FRACTION_BITS - INPUT_BITS - 4)
        loudness = (amplitude_index(colour) << INPUT_BITS) // PER_OCTAVE + (6 << INPUT_BITS)
        shapes = (shape.reshape(-1, k, 3).sum(axis=1) // k) >> (FRACTION_BITS - INPUT_BITS)
        joined = np.concatenate([colours, loudness[:, None], shapes], axis=1)
        summary: I64 = np.clip(joined, -_INPUT_LIMIT, _INPUT_LIMIT)
        return summary
