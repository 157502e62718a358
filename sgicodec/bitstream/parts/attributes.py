"""Seed attributes: symbols under the distributions that MLP_p predicts, pass after pass, group after group.

The same coder writes and reads. Everything from decoded symbols to the next distribution is integer arithmetic, so the
two directions agree on every machine (docs/format.md, "Context model").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import AttributeModel, RangeDecoder
from sgicodec.bitstream.entropy.symbol_coder import IntArray, SymbolCoder, SymbolReader
from sgicodec.bitstream.entropy.symbol_models import zero_centred_tables
from sgicodec.bitstream.entropy.tables import MAX_MAGNITUDE, SCALES
from sgicodec.device import ONE_THREAD, Device
from sgicodec.model.ahead import ahead
from sgicodec.model.context import (
    HashGrid,
    hash_inputs,
    input_count,
    nearest_by_pass,
    output_columns,
    output_count,
    passes,
)
from sgicodec.model.layout import SeedLayout
from sgicodec.model.native import SeedInputs, quantisers, summarise, write_own_inputs
from sgicodec.model.neighbours import nearest_seeds
from sgicodec.model.network import IntNetwork, Prediction
from sgicodec.model.quantization import quantize
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, follows_amplitude

__all__ = ["AttributeCoder"]

I16 = NDArray[np.int16]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]


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
    device: Device = ONE_THREAD
    matmul: Any = None

    def code(self, coder: SymbolCoder, values: dict[str, NDArray[np.float64]] | None) -> I64:
        """Writes the float attributes `values` by group [N, size], or reads if None. Returns the decoded attributes
        [N, d_A] in units of 2^-24, in the layout's order.
        """
        context, layout = self.spec.context, self.layout
        if values is None and isinstance(coder, SymbolReader) and self.matmul is None and not context.hash_resolutions:
            return self._read(coder)
        decoded = np.zeros((len(layout), self.spec.attributes), np.int64)
        seeds = SeedInputs(layout, self.quality, self.device)
        parts = nearest_by_pass(context, layout, nearest_seeds)
        widths = [input_count(self.spec, number) for number in range(len(context.steps))]
        if context.hash_resolutions:
            grid = HashGrid.at(context, layout, *self.size)
            signs = [2 * bits - 1 for bits in self.hash_tables]
        for members, neighbours in parts if self.device.threads == 1 else ahead(parts):
            if not len(members):
                continue
            inputs = np.empty((len(members), max(widths)), np.int16)
            seeds.write(members, neighbours, inputs)
            if context.hash_resolutions:
                hashed = hash_inputs(grid, members, signs, grid.weight, np.concatenate, _shift)
                inputs[:, widths[0] - hashed.shape[1] : widths[0]] = hashed
            self._code_pass(coder, members, inputs, widths, values, decoded)
            if context.neighbours:
                seeds.summary[members] = summarise(self.spec, decoded, members, self.device)[0]
        return decoded

    def _read(self, coder: SymbolReader) -> I64:
        """All in one native call, which lets other threads run: the same functions in the same order."""
        spec, layout = self.spec, self.layout
        decoded = np.zeros((len(layout), spec.attributes), np.int64)
        parts = passes(spec.context, layout)
        members = np.concatenate([np.zeros(0, np.int64), *parts])
        start = np.cumsum([0, *(len(part) for part in parts)], dtype=np.int64)
        model = self._native()

        def read(decoder: RangeDecoder) -> tuple[int, IntArray, list[float]]:
            sizes = np.ascontiguousarray(layout.half_pixels), layout.log_size
            threads = self.device.threads
            return model.read(decoder, zero_centred_tables(), *sizes, members, start, threads, decoded)

        coder.read(read, [name for step in spec.context.steps for name in step])
        return decoded

    def _native(self) -> AttributeModel:
        spec, context = self.spec, self.spec.context
        colour, shape = (spec.group(name).start if spec.skip else 0 for name in ("colour", "shape"))
        known = spec.attributes, spec.per_seed, spec.channels, colour, shape, self.quality, context.neighbours
        model = AttributeModel(*known, SCALES * self.family)
        for step, network in zip(context.steps, self.networks, strict=True):
            model.add_step(*network.arrays, network.shift, network.predicted, self.device.isa)
            units = 0
            for position, name in enumerate(step):
                columns, count = output_columns(spec, name), output_count(spec, name)
                model.add_group(
                    base=np.ascontiguousarray(self.plan.base[name][columns]),
                    columns=columns,
                    gamma=self.plan.gamma[name],
                    follows_amplitude=follows_amplitude(spec, name),
                    prediction=units,
                    units=count,
                    refinement=position,
                    first=spec.group(name).start,
                )
                units += count
        return model

    def _code_pass(
        self,
        coder: SymbolCoder,
        members: I64,
        inputs: I16,
        widths: list[int],
        values: dict[str, NDArray[np.float64]] | None,
        decoded: I64,
    ) -> None:
        """Codes the seeds `members`; inputs [n, most] hold what all steps see, the first widths[0] columns."""
        amplitude = None
        for number, step in enumerate(self.spec.context.steps):
            if number:
                summary, amplitude = summarise(self.spec, decoded, members, self.device)
                write_own_inputs(summary, number, widths[0], inputs, self.device)
            prediction = self.networks[number].predict(inputs[:, : widths[number]], self.matmul, self.device)
            start = 0
            for position, name in enumerate(step):
                units = slice(start, start + output_count(self.spec, name))
                start = units.stop
                part = Prediction(
                    prediction.mean[:, units], prediction.scale[:, units], prediction.refine[:, position : position + 1]
                )
                known = amplitude if follows_amplitude(self.spec, name) else None
                given = None if values is None else values[name][members]
                with coder.part(name):
                    self._code_group(coder, name, members, part, known, given, decoded)

    def _code_group(
        self,
        coder: SymbolCoder,
        name: str,
        members: I64,
        prediction: Prediction,
        amplitude: I32 | None,
        values: NDArray[np.float64] | None,
        decoded: I64,
    ) -> None:
        known = quantisers(
            self.spec, self.plan, name, prediction, amplitude, self.layout.log_size[members], self.device
        )
        symbols = None
        if values is not None:
            symbols = quantize(values, known.mean, known.step, known.scale)
            symbols = np.clip(symbols, -MAX_MAGNITUDE, MAX_MAGNITUDE)
        coded = coder.code(symbols, known.scale + np.int16(SCALES * self.family))
        known.decode(coded, members, self.spec.group(name).start, decoded, self.device)
