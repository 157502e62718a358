"""Files of networks that ship with the library: 16-bit integers, little-endian; for each network its inputs, hidden,
outputs, predicted and shift, then W1, b1, W2, b2.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

from sgicodec.model.network import IntNetwork

__all__ = ["SHIFT", "parse_prior", "write_prior"]

SHIFT = 8
"""Shipped weights are multiples of 2^-8."""


def write_prior(networks: tuple[IntNetwork, ...], path: Path) -> str:
    """Writes a file and returns its SHA-256."""
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


def parse_prior(data: bytes) -> tuple[IntNetwork, ...]:
    """The networks of a file."""
    numbers = np.frombuffer(data, "<i2").astype(np.int64)
    networks, at = [], 0
    while at < len(numbers):
        inputs, hidden, outputs, predicted, shift = numbers[at : at + 5].tolist()
        sizes = np.cumsum([hidden * inputs, hidden, outputs * hidden, outputs])
        w1, b1, w2, b2, _ = np.split(numbers[at + 5 :], sizes)
        networks.append(IntNetwork(w1.reshape(hidden, inputs), b1, w2.reshape(outputs, hidden), b2, shift, predicted))
        at += 5 + int(sizes[-1])
    return tuple(networks)
