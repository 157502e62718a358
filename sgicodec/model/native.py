"""The context model's arithmetic in native code: integers throughout, so that no processor changes a symbol.

docs/format.md, "Context model", is the specification; `context.py` holds what training needs of it in floats.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.device import Device
from sgicodec.model.context import SUMMARY
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec

__all__ = ["SeedInputs", "summarise"]

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
