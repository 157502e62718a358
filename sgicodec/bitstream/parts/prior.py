"""Priors: MLP_p trained over many pictures. Of the shipped one a file pays for no weights."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from sgicodec import _native
from sgicodec.bitstream.limits import spec_fields
from sgicodec.errors import CorruptStreamError, UsageError
from sgicodec.model.context import network_shapes
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec

_NUMBER = np.dtype("<i2")
"""Of all that a file holds."""
_HEAD = 5
"""Numbers before the weights of a network: inputs, hidden units, outputs, predictions, shift."""


@cache
def load_prior(spec: ModelSpec) -> tuple[IntNetwork, ...]:
    """The networks of `spec.context.prior`, one per coding step.

    Raises UnsupportedStreamError for a prior that this version does not have or that does not fit the model.
    """
    return tuple(IntNetwork(*network) for network in _native.load_prior(spec_fields(spec, 1, 1)))


@cache
def parse_prior(data: bytes, spec: ModelSpec) -> tuple[IntNetwork, ...]:
    """The networks of a file, one per coding step (docs/format.md, "Prior").

    Raises UsageError for a file that does not hold networks for this model.
    """
    numbers = np.frombuffer(data, _NUMBER, len(data) // _NUMBER.itemsize).astype(np.int64)
    networks, at = [], 0
    for step, stage in enumerate(spec.context.steps):
        shapes = network_shapes(spec, step)
        outputs, (hidden, inputs) = shapes["w2"][0], shapes["w1"]
        *sizes, shift = numbers[at : at + _HEAD].tolist() or [0]
        if sizes != [inputs, hidden, outputs, (outputs - len(stage)) // 2]:
            raise UsageError(
                f"this is no prior: its network {step + 1} is not one of {inputs} inputs and {outputs} outputs"
            )
        at += _HEAD
        arrays = []
        for shape in shapes.values():
            arrays.append(numbers[at : at + math.prod(shape)])
            at += math.prod(shape)
        if at > len(numbers):
            raise UsageError(f"this is no prior: it ends within network {step + 1}")
        w1, b1, w2, b2 = (array.reshape(shape) for array, shape in zip(arrays, shapes.values(), strict=True))
        try:
            networks.append(IntNetwork(w1, b1, w2, b2, shift, sizes[-1]))
        except CorruptStreamError as error:
            raise UsageError(f"this is no prior: {error}") from error
    if len(data) != at * _NUMBER.itemsize:
        raise UsageError(f"this is no prior: it has {len(data)} bytes, not {at * _NUMBER.itemsize}")
    return tuple(networks)
