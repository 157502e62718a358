"""The shipped prior: MLP_p trained over many pictures, so that a small file pays for no weights."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.resources import files

import numpy as np

from sgicodec.errors import UnsupportedStreamError
from sgicodec.model.context import input_count
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec

__all__ = ["PRIORS", "load_prior", "parse_prior"]

PRIORS: dict[int, str] = {3: "d9685f69a2b79fcd846e92723fe0757b9dbf1673eed61b7d19320ee5c7ece104"}
"""SHA-256 of every prior's file, by the number with which a stream names it."""


def load_prior(spec: ModelSpec) -> tuple[IntNetwork, ...]:
    """The networks of `spec.context.prior`, one per coding step.

    Raises UnsupportedStreamError for a prior that this version does not have or that does not fit the model.
    """
    number = spec.context.prior
    if number not in PRIORS:
        raise UnsupportedStreamError(f"prior {number} is unknown; this program has prior {max(PRIORS)}")
    networks = _networks(number)
    fits = len(networks) == len(spec.context.steps) and all(
        network.w1.shape == (spec.context.hidden, input_count(spec, step)) for step, network in enumerate(networks)
    )
    if not fits:
        raise UnsupportedStreamError(f"prior {number} does not fit the model that the header describes")
    return networks


@cache
def _networks(number: int) -> tuple[IntNetwork, ...]:
    data = files("sgicodec.bitstream.parts").joinpath(f"prior{number}.bin").read_bytes()
    if hashlib.sha256(data).hexdigest() != PRIORS[number]:
        raise UnsupportedStreamError(f"prior {number} of this installation is damaged; install the package again")
    return parse_prior(data)


def parse_prior(data: bytes) -> tuple[IntNetwork, ...]:
    """The networks of a prior's file: int16, little-endian; for each network its inputs, hidden, outputs, predicted and
    shift, then W1, b1, W2, b2.
    """
    numbers = np.frombuffer(data, "<i2").astype(np.int64)
    networks, at = [], 0
    while at < len(numbers):
        inputs, hidden, outputs, predicted, shift = (int(v) for v in numbers[at : at + 5])
        at += 5
        parts = []
        for shape in ((hidden, inputs), (hidden,), (outputs, hidden), (outputs,)):
            size = int(np.prod(shape))
            parts.append(numbers[at : at + size].reshape(shape))
            at += size
        w1, b1, w2, b2 = parts
        networks.append(IntNetwork(w1, b1, w2, b2, shift=shift, predicted=predicted))
    return tuple(networks)
