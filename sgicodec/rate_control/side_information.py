"""Estimates of what a stream holds beside the attributes of its seeds."""

from __future__ import annotations

__all__ = [
    "EMPTY_STREAM_BYTES",
    "SEED_POSITION_BITS",
    "network_bytes",
    "side_bytes",
    "tile_side_bytes",
]

SEED_POSITION_BITS = 4.0
"""Of the position of a seed: 2.6 to 4.5 in three Kodak streams. The convergence table was measured with this value;
RDOQ prunes with a price of 3 (rdoq/settings.py), with which it was tuned.
"""
EMPTY_STREAM_BYTES = 200.0
"""Of a stream without seeds, base layer included."""
HEADER_BYTES = 250.0
"""Of header, steps and network differences of a stream of one tile, whose base layer is counted by its numbers. The
R-D model was fitted with EMPTY_STREAM_BYTES instead.
"""
TILE_BYTES = 30.0
"""Of one tile of several without seeds: the header is the stream's."""
BASE_NUMBER_BYTES = 0.4
"""For each number of the base layer."""
NETWORK_WEIGHT_BYTES = 1.2
"""For each weight of a network that travels in the stream."""


def network_bytes(weights: int) -> float:
    """Bytes of a context network of `weights` weights that the stream carries."""
    return NETWORK_WEIGHT_BYTES * weights


def side_bytes(base_numbers: float, extra: float) -> float:
    """Bytes of a stream of one tile beside its seeds; `extra`: metadata and networks."""
    return HEADER_BYTES + BASE_NUMBER_BYTES * base_numbers + extra


def tile_side_bytes(weights: int) -> float:
    """Bytes of a tile of several without seeds, with a network of `weights` weights."""
    return TILE_BYTES + network_bytes(weights)
