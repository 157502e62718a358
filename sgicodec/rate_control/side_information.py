"""Estimates of what a stream holds beside the attributes of its seeds."""

from __future__ import annotations

__all__ = [
    "EMPTY_STREAM_BYTES",
    "network_bytes",
    "tile_side_bytes",
]

EMPTY_STREAM_BYTES = 200.0
"""Of a stream without seeds, base layer included."""
TILE_BYTES = 30.0
"""Of one tile of several without seeds: the header is the stream's."""
NETWORK_WEIGHT_BYTES = 1.2
"""For each weight of a network that travels in the stream."""


def network_bytes(weights: int) -> float:
    """Bytes of a context network of `weights` weights that the stream carries."""
    return NETWORK_WEIGHT_BYTES * weights


def tile_side_bytes(weights: int) -> float:
    """Bytes of a tile of several without seeds, with a network of `weights` weights."""
    return TILE_BYTES + network_bytes(weights)
