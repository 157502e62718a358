"""Writing what `parse_prior` reads (docs/format.md, "Prior")."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sgicodec.model.network import IntNetwork


def prior_file(networks: Sequence[IntNetwork]) -> bytes:
    """The file of networks, as `parse_prior` takes it."""
    parts = []
    for network in networks:
        (hidden, inputs), outputs = network.w1.shape, len(network.w2)
        parts.append(np.array([inputs, hidden, outputs, network.predicted, network.shift]))
        parts += [array.reshape(-1) for array in network.arrays]
    return np.concatenate(parts).astype("<i2").tobytes()
