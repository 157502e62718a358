"""Writes the files that `bitstream.prior` reads: networks in 16-bit integers."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

from sgicodec.model.network import IntNetwork

__all__ = ["SHIFT", "write_prior"]

SHIFT = 8
"""Shipped weights are multiples of 2^-8."""


def write_prior(networks: tuple[IntNetwork, ...], path: Path) -> str:
    """Writes the file that `bitstream.prior` reads and returns its SHA-256."""
    blocks = []
    for network in networks:
        hidden, inputs = network.w1.shape
        head = [inputs, hidden, network.w2.shape[0], network.predicted, network.shift]
        parts = [np.array(head), network.w1, network.b1, network.w2, network.b2]
        values = np.concatenate([part.reshape(-1) for part in parts])
        if np.abs(values).max() > 32767:
            raise ValueError("a weight does not fit into 16 bits")
        blocks.append(values.astype("<i2"))
    data = np.concatenate(blocks).tobytes()
    path.write_bytes(data)
    return hashlib.sha256(data).hexdigest()
