"""The restoration part of a tile: a network, and the step in which it sees pixels (docs/format.md, "Restoration")."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.parts.arrays import write_weights
from sgicodec.model.restoration import Restoration

__all__ = ["write_restoration"]

_NETWORK_BITS, _STEP_BITS, _UNIT_BITS = 4, 9, 3
_CHANGED = 8
_LARGEST_UNIT = 6


def write_restoration(writer: SymbolWriter, restoration: Restoration | None) -> None:
    """A tile's restoration, None where it has none."""
    if restoration is None:
        writer.code_int(0, _NETWORK_BITS)
        return
    writer.code_int(restoration.network + (_CHANGED if restoration.changes else 0), _NETWORK_BITS)
    writer.code_int(restoration.step, _STEP_BITS)
    for change in restoration.changes:
        _write_change(writer, change)


def _write_change(writer: SymbolWriter, change: NDArray[np.int32]) -> None:
    """What is added to a layer: in units of the largest power of two that divides it, output after output."""
    if not change.any():
        writer.code_int(0, _UNIT_BITS)
        return
    power = next(power for power in range(_LARGEST_UNIT, -1, -1) if not (change % (1 << power)).any())
    writer.code_int(power + 1, _UNIT_BITS)
    for output in change >> power:
        write_weights(writer, output, output.shape)
