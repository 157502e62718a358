"""The context model's arithmetic in native code: integers throughout, so that no processor changes a symbol.

docs/format.md, "Context model", is the specification; `context.py` holds what training needs of it in floats.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.device import Device
from sgicodec.model.context import SUMMARY, output_columns
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import Prediction
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan

__all__ = ["Quantisers", "SeedInputs", "quantisers", "summarise", "write_own_inputs"]

I16 = NDArray[np.int16]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]


class SeedInputs:
    """What MLP_p sees of seeds before any of their own values: cell size, quality, and neighbours' summaries."""

    def __init__(self, layout: SeedLayout, quality: int, device: Device) -> None:
        self._half_pixels, self._log_size = np.ascontiguousarray(layout.half_pixels), layout.log_size
        self._quality, self._threads = quality, device.threads
        self.summary: I16 = np.zeros((len(layout), SUMMARY), np.int16)
        """Summaries of the seeds decoded so far, zeros for others."""

    def write(self, members: I64, neighbours: I32, out: I16) -> None:
        """Inputs 1 and 2 of the format of the seeds `members` [n] into the first columns of out [n, inputs].

        neighbours [n, k]: nearest seeds of earlier passes, −1 where there is none; k = 0 for none at all.
        """
        _native.seed_inputs(
            self._half_pixels,
            self._log_size,
            neighbours,
            self.summary,
            members,
            self._quality,
            self._threads,
            out,
        )


def summarise(spec: ModelSpec, decoded: I64, members: I64, device: Device) -> tuple[I16, I32]:
    """Summaries [n, SUMMARY] in input units and amplitude indices [n] of the seeds `members` of decoded [N, d_A]."""
    summary = np.empty((len(members), SUMMARY), np.int16)
    amplitude = np.empty(len(members), np.int32)
    colour, shape = spec.group("colour").start, spec.group("shape").start
    _native.summarise(decoded, spec.channels, colour, shape, members, device.threads, summary, amplitude)
    return summary, amplitude


def write_own_inputs(summary: I16, step: int, first: int, out: I16, device: Device) -> None:
    """Input 4 of the format of seeds with these summaries [n, SUMMARY] into the columns from `first` on of
    out [n, inputs], for the second step (1) or a later one.
    """
    _native.own_inputs(summary, step, first, device.threads, out)


@dataclass(frozen=True)
class Quantisers:
    """How each attribute of a group [n, size] is coded: predicted mean and step in units of 2^-24, scale index."""

    mean: I64
    step: I64
    scale: I16

    def decode(self, symbols: I32, members: I64, first: int, decoded: I64, device: Device) -> None:
        """Writes m + q·n of symbols [n, size] to the columns from `first` on of rows `members` of decoded [N, d_A]."""
        _native.dequantise(symbols, self.mean, self.step, members, first, device.threads, decoded)


def quantisers(
    spec: ModelSpec,
    plan: StepPlan,
    group: str,
    prediction: Prediction,
    amplitude: I32 | None,
    log_size: NDArray[np.int8],
    device: Device,
) -> Quantisers:
    """What MLP_p's prediction for a group means for n seeds in cells of `log_size` [n] (docs/format.md, "Passes").

    prediction: the columns of this group alone; amplitude [n], None where the group's steps do not follow it.
    """
    columns = output_columns(spec, group)
    shape = (len(log_size), len(columns))
    mean, step, scale = np.empty(shape, np.int64), np.empty(shape, np.int64), np.empty(shape, np.int16)
    _native.quantisers(
        np.ascontiguousarray(plan.base[group][columns]),
        columns,
        plan.gamma[group],
        amplitude,
        prediction.mean,
        prediction.scale,
        prediction.refine,
        log_size,
        device.threads,
        mean,
        step,
        scale,
    )
    return Quantisers(mean, step, scale)
