"""Restoration: a network that takes from drawn pixels what quantisation added to them (docs/format.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sgicodec._native import restoration_correction
from sgicodec.arrays import F32
from sgicodec.device import ONE_THREAD, Device


@dataclass(frozen=True)
class Restoration:
    """What a tile's pixels pass through. network: number of a shipped one, or the file of the picture's own; step:
    index of the step in whose units it sees them, 2^((step − 480) / 32).
    """

    network: int | bytes
    step: int

    def correction(self, drawn: F32, device: Device = ONE_THREAD) -> F32:
        """What is added to a whole tile [C, H, W] at its own pixels, in the channels that the stream codes.

        Equal for any number of threads and instruction set.
        """
        planes = np.ascontiguousarray(drawn)
        return restoration_correction(planes, self.network, self.step, device.threads, device.isa)
