"""The shipped prior: MLP_p trained over many pictures, so that a small file pays for no weights."""

from __future__ import annotations

from functools import cache

from sgicodec import _native
from sgicodec.bitstream.limits import spec_fields
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec

__all__ = ["load_prior"]


@cache
def load_prior(spec: ModelSpec) -> tuple[IntNetwork, ...]:
    """The networks of `spec.context.prior`, one per coding step.

    Raises UnsupportedStreamError for a prior that this version does not have or that does not fit the model.
    """
    return tuple(IntNetwork(*network) for network in _native.load_prior(spec_fields(spec, 1, 1)))
