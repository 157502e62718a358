"""The restoration part of a tile: a network, and the step in which it sees pixels (docs/format.md, "Restoration")."""

from __future__ import annotations

from sgicodec._native import OWN_NETWORK
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.model.restoration import Restoration

__all__ = ["write_restoration"]

_NETWORK_BITS, _STEP_BITS = 4, 9


def write_restoration(writer: SymbolWriter, restoration: Restoration | None) -> None:
    """A tile's restoration, None where it has none."""
    if restoration is None:
        writer.code_int(0, _NETWORK_BITS)
        return
    network = restoration.network
    writer.code_int(OWN_NETWORK if isinstance(network, bytes) else network, _NETWORK_BITS)
    writer.code_int(restoration.step, _STEP_BITS)
